"""revisit-play locate, through its command line: photographs of walls that differ from floor to floor."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

cv2 = pytest.importorskip("cv2")
pytest.importorskip("rapidocr")

import numpy as np  # noqa: E402

WIDTH_PX, HEIGHT_PX, STEP_PX = 640, 360, 40
FLOORS = ("1", "2")
FRAMES = 8
# Every fourth photograph asks.
ASKING = range(4, FRAMES + 1, 4)


def locate(*arguments: object) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "revisit_slam.play", "locate", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True)


def wall(seed: int) -> np.ndarray:
    """Draw boxes of all sizes: corners that no other wall has."""
    rng = np.random.default_rng(seed)
    picture = np.full((HEIGHT_PX, WIDTH_PX + STEP_PX * FRAMES, 3), 128, np.uint8)
    for _ in range(700):
        x, y = int(rng.integers(picture.shape[1])), int(rng.integers(HEIGHT_PX))
        width, height = (int(side) for side in rng.integers(6, 60, 2))
        cv2.rectangle(picture, (x, y), (x + width, y + height), tuple(int(c) for c in rng.integers(0, 256, 3)), -1)
    return picture


@pytest.fixture(scope="module")
def tower(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A walk along one wall of each floor, and `floors.csv`."""
    folder = tmp_path_factory.mktemp("tower")
    rows = ["frame,floor,split"]
    for floor in FLOORS:
        whole = wall(int(floor))
        for number in range(1, FRAMES + 1):
            name = f"f{floor}_frame_{number:06}"
            left = STEP_PX * (number - 1)
            assert cv2.imwrite(str(folder / f"{name}.png"), whole[:, left : left + WIDTH_PX])
            rows.append(f"{name},{floor},{'query' if number in ASKING else 'gallery'}")
    (folder / "floors.csv").write_text("\n".join(rows) + "\n")
    return folder


def test_photographs_are_located_where_their_neighbours_hang_and_nowhere_without_them(tower: Path) -> None:
    done = locate("--gallery", tower, "--queries", tower, "--truth", tower / "floors.csv", "--json")
    assert done.returncode == 0, done.stderr
    asked = len(FLOORS) * len(ASKING)
    figures = json.loads(done.stdout)["protocols"]
    assert figures["A"] == {"queries": asked, "located": asked, "wrong": 0, "top1": 1.0}
    assert (figures["C"]["queries"], figures["C"]["located"]) == (asked, 0)


def test_two_folders_without_a_truth_give_the_answers(tower: Path, tmp_path: Path) -> None:
    gallery, queries = tmp_path / "gallery", tmp_path / "queries"
    for folder in (gallery, queries):
        folder.mkdir()
    for path in tower.glob("*.png"):
        is_asking = int(path.stem[-6:]) in ASKING
        (queries / f"phone_{path.name}" if is_asking else gallery / path.name).write_bytes(path.read_bytes())
    done = locate("--gallery", gallery, "--queries", queries, "--json")
    assert done.returncode == 0, done.stderr
    answers = {answer["photograph"]: answer for answer in json.loads(done.stdout)["answers"]}
    assert len(answers) == len(FLOORS) * len(ASKING)
    for name, answer in answers.items():
        floor = name.split("_")[1]
        assert (answer["verdict"], answer["places"][0]["map"]) == ("located", f"video-{floor}-1")


def test_the_table_shows_ordinary_methods_beside_it(tower: Path) -> None:
    done = locate("--gallery", tower, "--queries", tower, "--truth", tower / "floors.csv", "--orb")
    assert done.returncode == 0, done.stderr
    for shown in ("wrong floor", "ORB, best by words", "DINOv2 ViT-S/14, 518 px", "as the authors"):
        assert shown in done.stdout


@pytest.mark.parametrize(
    ("rows", "complaint"),
    [
        (["frame,floor"], "no columns `frame` and `floor` and `split` in its first line, which is: frame, floor"),
        (["frame,level,split"], "no columns `frame` and `floor` and `split`"),
        (["frame,floor,split", "f1_frame_000001,1,other"], "`split` is `other`; known are gallery and query: truth.csv, line 2"),
        (["frame,floor,split", "f1_frame_000001,,query"], "`frame` and `floor` and `split` must not be empty: truth.csv, line 2"),
        (["frame,floor,split", "f1_frame_000001,1,query", "f1_frame_000001.png,2,query"], "stands there twice, with different values: truth.csv, line 3"),
        (["frame,floor,split", "f1_frame_000001,1,query"], "no floor for f1_frame_000002.png and 14 others"),
    ],
)
def test_a_faulty_truth_is_one_line_that_names_the_file(tower: Path, tmp_path: Path, rows: list[str], complaint: str) -> None:
    truth = tmp_path / "truth.csv"
    truth.write_text("\n".join(rows) + "\n")
    done = locate("--gallery", tower, "--queries", tower, "--truth", truth)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (1, "", 1)
    assert str(truth) in done.stderr and complaint in done.stderr


def test_a_truth_of_excel_and_photographs_that_cannot_be_judged_do_not_end_the_run(tower: Path, tmp_path: Path) -> None:
    folder = tmp_path / "walk"
    folder.mkdir()
    for path in tower.glob("*.png"):
        (folder / path.name).write_bytes(path.read_bytes())
    (folder / "f1_frame_000002.png").write_bytes((folder / "f1_frame_000002.png").read_bytes()[:100])
    (folder / "f2_frame_000009.png").write_bytes((folder / "f2_frame_000008.png").read_bytes())
    rows = (tower / "floors.csv").read_text().replace("frame,floor,split", "Frame, Floor ,SPLIT").replace(",", ";").splitlines()
    (folder / "floors.csv").write_text("sep=;\n" + "\r\n".join([*rows, "f1_frame_000003;;query"]), encoding="utf-16")
    done = locate("--gallery", folder, "--queries", folder, "--truth", folder / "floors.csv", "--json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["protocols"]["A"]["queries"] == len(FLOORS) * len(ASKING)
    for told in ("f1_frame_000002.png", "f2_frame_000009.png", "floors.csv, line 19"):
        assert told in done.stderr
    assert "no floor in floors.csv, so not judged" in done.stderr


def test_a_truth_judges_what_it_names_and_no_more(tmp_path: Path) -> None:
    from revisit_slam.pixels.frames import Frame
    from revisit_slam.pixels.truth import Truth

    names = ["up/0001.jpg", "down/0001.jpg", "1700000000.25.png", "hall.HEIC", "stairs.jpg", "roof.jpg", "lift.jpg"]
    names.append("north/hall.jpg")
    frames = [Frame(name.rsplit(".", 1)[0].replace("/", "."), tmp_path / name, "", number) for number, name in enumerate(names)]
    rows = ["up\\0001.jpg,2", "north.hall,1", "down/0001,1", "other/1700000000.25.jpg,2", "hall,1", "stairs.jpg,1"]
    (tmp_path / "truth.csv").write_text("\n".join(["frame,floor", *rows, "stairs.png,2", "roof.jpg,", "lift.jpg,1"]))
    truth = Truth(tmp_path / "truth.csv", frames)
    assert truth.same_floor("up.0001", "1700000000.25") and truth.same_floor("down.0001", "hall")
    assert not truth.same_floor("up.0001", "down.0001")
    # What is not known is neither right nor wrong.
    assert truth.lists("stairs", ["roof", "up.0001"]) == ([], ["roof", "up.0001"])
    assert truth.left_out.told() == [
        "left out 1: stairs.png stands there twice, with different values: truth.csv, line 8",
        "left out 1: `frame` and `floor` must not be empty: truth.csv, line 9",
        "left out 2: no floor in truth.csv, so not judged: stairs.jpg, roof.jpg",
    ]


def test_two_floors_are_two_maps_however_they_are_written(tmp_path: Path, tower: Path) -> None:
    from revisit_slam.pixels.locate.collection import open_collection

    picture = next(tower.glob("*.png")).read_bytes()
    for name in ("a_1.png", "b_1.png"):
        (tmp_path / "gallery").mkdir(exist_ok=True)
        (tmp_path / "gallery" / name).write_bytes(picture)
    (tmp_path / "truth.csv").write_text("frame,floor\na_1,東\nb_1,西\n", encoding="utf-8-sig")
    (tmp_path / "queries").mkdir()
    (tmp_path / "queries" / "a_1.png").write_bytes(picture)
    assert len(open_collection(tmp_path / "gallery", tmp_path / "queries", tmp_path / "truth.csv").maps) == 2


def test_one_folder_needs_a_truth_that_parts_it(tower: Path) -> None:
    done = locate("--gallery", tower, "--queries", tower)
    assert done.returncode == 1 and "--truth CSV with a column `split`" in done.stderr


def test_protocols_leave_out_the_photographs_own_video_and_no_other() -> None:
    from revisit_slam.pixels.frames import Frame
    from revisit_slam.pixels.locate.collection import Shot
    from revisit_slam.pixels.locate.protocols import Excluded, excluded

    def shot(video: str, number: int) -> Shot:
        return Shot(Frame(f"{video}-{number}", Path("x"), video, number), "floor-1", f"{video}-1", True)

    gallery = [shot(video, number) for video in ("a", "b") for number in (2, 3, 5, 7, 8)]
    assert excluded("A", shot("a", 5), gallery) == Excluded()
    assert excluded("B", shot("a", 5), gallery) == Excluded(keyframes=("a-3", "a-5", "a-7"))
    assert excluded("C", shot("a", 5), gallery) == Excluded(sessions=("a-1",))
    # A video that the gallery does not have leaves nothing to leave out.
    assert {excluded(protocol, shot("c", 5), gallery) for protocol in "ABC"} == {Excluded()}


def test_a_global_descriptor_proposes_what_geometry_then_finds_also_in_the_dark(tower: Path) -> None:
    both = ("--gallery", tower, "--queries", tower, "--truth", tower / "floors.csv", "--json")
    done = locate(*both, "--channels", "global", "--distort", "dim")
    assert done.returncode == 0, done.stderr
    figures = json.loads(done.stdout)["protocols"]["A"]
    assert (figures["located"], figures["wrong"]) == (len(FLOORS) * len(ASKING), 0)


def test_distortions_are_the_same_every_time_and_a_crop_keeps_the_scale() -> None:
    from revisit_slam.pixels.locate.distortions import DISTORTIONS

    picture = wall(3)[:, :WIDTH_PX]
    for name, distort in DISTORTIONS.items():
        assert np.array_equal(distort(picture), distort(picture.copy())), name
        assert not np.array_equal(distort(picture), picture), name
    cropped = DISTORTIONS["crop"](picture)
    top, left = (HEIGHT_PX - cropped.shape[0]) // 2, (WIDTH_PX - cropped.shape[1]) // 2
    assert np.array_equal(cropped, picture[top : top + cropped.shape[0], left : left + cropped.shape[1]])
    assert DISTORTIONS["dim"](picture).mean() < picture.mean() < DISTORTIONS["bright"](picture).mean()
