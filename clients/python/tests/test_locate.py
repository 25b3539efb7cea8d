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
        (["frame,floor"], "its first line has no column `split`"),
        (["frame,level,split"], "its first line has no column `floor`"),
        (["frame,floor,split", "f1_frame_000001,1,other"], "line 2: `split` is `other`"),
        (["frame,floor,split", "f1_frame_000001,,query"], "line 2: `frame` and `floor` must not be empty"),
        (["frame,floor,split", "f1_frame_000001,1,query", "f1_frame_000001.png,2,query"], "line 3: f1_frame_000001.png stands"),
        (["frame,floor,split", "f1_frame_000001,1,query"], "no row for f1_frame_000002.png"),
    ],
)
def test_a_faulty_truth_is_one_line_that_names_the_file(tower: Path, tmp_path: Path, rows: list[str], complaint: str) -> None:
    truth = tmp_path / "truth.csv"
    truth.write_text("\n".join(rows) + "\n")
    done = locate("--gallery", tower, "--queries", tower, "--truth", truth)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (1, "", 1)
    assert str(truth) in done.stderr and complaint in done.stderr


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
