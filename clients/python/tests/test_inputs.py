"""Inputs: files say what they are, one bad file does not end a run, and the doctor says what would be read."""

import base64
import io
import json
import os
import shutil
from collections.abc import Callable
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest

cv2 = pytest.importorskip("cv2")
pytest.importorskip("rapidocr")
pytest.importorskip("rosbags")
pytest.importorskip("pycolmap")

import fixtures  # noqa: E402
import foreign_maps  # noqa: E402
import foreign_world  # noqa: E402
import zstandard  # noqa: E402
from fixtures import Timed  # noqa: E402
from test_plans import BUILDING  # noqa: E402
from test_play import play  # noqa: E402

from revisit_slam.arguments import check, parser  # noqa: E402
from revisit_slam.errors import RevisitError  # noqa: E402
from revisit_slam.left_out import LeftOut  # noqa: E402
from revisit_slam.pixels.camera import Calibration  # noqa: E402
from revisit_slam.pixels.frames import Frame, list_frames, readable  # noqa: E402
from revisit_slam.pixels.sources.bag.pictures import ENCODINGS, frames_of  # noqa: E402
from revisit_slam.pixels.sources.opening import open_source  # noqa: E402
from revisit_slam.pixels.sources.source import Source  # noqa: E402
from revisit_slam.pixels.turn import Turn, moved  # noqa: E402
from revisit_slam.play import main  # noqa: E402

ORIENTATION = 0x0112
# The camera of the sample building, which takes the fixtures' pictures.
CAMERA = ("--calibration", "600,600,400,300")


@pytest.fixture(scope="module")
def one_visit() -> list[Timed]:
    return fixtures.timed("1")


@pytest.fixture(scope="module")
def cache(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return Path(os.environ.get("REVISIT_SAMPLE_READINGS") or tmp_path_factory.mktemp("readings"))


def opened(tmp_path: Path, command: str, path: Path, *more: object) -> Source:
    """Open what a command line names, as the player does, and keep what can be read."""
    work = tmp_path / "work"
    work.mkdir(exist_ok=True)
    chosen = parser().parse_args([command, str(path), *map(str, more)])
    check(chosen)
    source = open_source(chosen, work)
    source.frames[:] = [frame for _, frame, _, _ in readable(source.frames, None, source.left_out)]
    return source


def told(source: Source) -> str:
    return "\n".join(source.told())


def plates(*texts: str, width: int = 640, height: int = 480) -> np.ndarray:
    """Draw a wall with texts, one below the other."""
    wall = np.full((height, width, 3), 200, np.uint8)
    for number, text in enumerate(texts):
        cv2.putText(wall, text, (60, 120 + 150 * number), cv2.FONT_HERSHEY_DUPLEX, 2.0, (20, 20, 20), 4, cv2.LINE_AA)
    return wall


def encoded(image: np.ndarray, form: str = "JPEG", orientation: int = 1) -> bytes:
    """Return a picture's file; of another orientation it is the stored picture that is given."""
    from PIL import Image

    exif, file = Image.Exif(), io.BytesIO()
    exif[ORIENTATION] = orientation
    Image.fromarray(np.ascontiguousarray(image[:, :, ::-1])).save(file, form, exif=exif)
    return file.getvalue()


# Files that are no pictures, by the name that a camera, a Mac or a download gives them.
JPEG = encoded(plates("12"))
BAD = {
    "empty.jpg": (b"", "it is empty"),
    "cut.jpg": (JPEG[: len(JPEG) // 2], "a JPEG picture, damaged or cut short"),
    "cut.png": (encoded(plates("12"), "PNG")[:900], "a PNG picture, damaged or cut short"),
    "page.jpg": (b"<!DOCTYPE html><html>", "it is a web page"),
    "lfs.png": (b"version https://git-lfs.github.com/spec/v1\n", "`git lfs pull` fetches"),
    "text.jpg": (b"no picture", "not a picture that OpenCV reads"),
    "pixel.png": (encoded(plates("")[:1, :1], "PNG"), "1 x 1 pixels, which show nothing"),
    "line.png": (encoded(plates("")[:2], "PNG"), "640 x 2 pixels, which show nothing"),
    "film.gif": (b"GIF89a", ".gif is not read here: save it as JPEG or PNG"),
    "map.jp2": (b"\0\0\0\x0cjP", ".jp2 is not read here"),
    "raw.CR2": (b"II*\0", ".cr2 is not read here"),
}
HIDDEN = ("._good_1.jpg", ".thumbnails/good_1.jpg", "__MACOSX/._good_1.jpg", "__MACOSX/good_1.jpg", "@eaDir/good_1.jpg/S.jpg")


def test_what_is_no_picture_is_left_out_with_its_reason_and_what_is_hidden_never_counts(cache: Path, tmp_path: Path) -> None:
    folder = tmp_path / "photographs"
    for name, data in {**{name: data for name, (data, _) in BAD.items()}, **dict.fromkeys(HIDDEN, b"\0\5\x16\7"), "good_1.jpg": JPEG}.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(data)
    report = tmp_path / "report.html"
    done = play("images", folder, "--cache", cache, "--report", report)
    assert done.returncode == 0, done.stderr
    for name, (_, why) in BAD.items():
        assert any(f"/{name}" in line and why in line for line in done.stderr.splitlines() if "left out" in line), name
    assert sum(int(line.split("left out ")[1].split(":")[0]) for line in done.stderr.splitlines() if "left out" in line) == len(BAD)
    assert not any(name in done.stderr for name in HIDDEN)
    first = done.stdout.splitlines()[0]
    assert first.startswith(f"{folder}: reads 9 pictures; poses: rotations") and "left out 1: .gif is not read here" in first
    assert "assumed: a focal length of 0.75 of the longer side" in first and "assumed: pictures are a second apart" in first
    page = report.read_text()
    assert "left out 1: .gif is not read here" in page and page.index("reads 1 pictures") < page.index("<table>")


def test_where_nothing_can_be_played_the_run_ends_with_1_and_every_reason(tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    for name in ("empty.jpg", "cut.jpg"):
        (tmp_path / "in" / name).write_bytes(BAD[name][0])
    done = play("images", tmp_path / "in", "--no-query", "-o", tmp_path / "o.ndjson")
    assert done.returncode == 1
    for word in ("in: nothing to play", "it is empty: ", "empty.jpg", "damaged or cut short: ", "cut.jpg"):
        assert word in done.stderr
    (tmp_path / "gifs").mkdir()
    (tmp_path / "gifs" / "a.gif").write_bytes(b"GIF89a")
    with pytest.raises(RevisitError, match="no photographs in it .*; left out 1: .gif is not read here"):
        list_frames(tmp_path / "gifs")


def test_heic_is_read_where_the_package_is_and_told_where_it_is_not(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    seen = plates("305", width=320, height=400)
    try:
        import pillow_heif
        from PIL import Image

        file = io.BytesIO()
        pillow_heif.from_pillow(Image.fromarray(seen[:, :, ::-1].copy())).save(file, quality=95)
        data = file.getvalue()
    except ImportError:
        data = b"\0\0\0\x18ftypheic\0\0\0\0mif1heic"
        stood_in = ModuleType("pillow_heif")
        stood_in.read_heif = lambda _: SimpleNamespace(to_pillow=lambda: Image.fromarray(seen[:, :, ::-1].copy()))
        monkeypatch.setitem(__import__("sys").modules, "pillow_heif", stood_in)
        from PIL import Image
    for name in ("IMG_1.HEIC", "IMG_2.jpg"):  # Phones name some of them as the other.
        (tmp_path / name).write_bytes(data)
    frames = list_frames(tmp_path)
    assert len(frames) == 2
    for frame in frames:
        assert np.abs(frame.view().image.astype(int) - seen).mean() < 2
    (tmp_path / "IMG_2.jpg").write_bytes(data[:40])
    monkeypatch.setitem(__import__("sys").modules, "pillow_heif", None)
    left_out = LeftOut()
    frames = list_frames(tmp_path, left_out)
    assert [*readable(frames, None, left_out)] == []
    (line,) = left_out.told()
    assert line.startswith("left out 2: a HEIC picture: install revisit-slam[heic]")


# How a picture is stored that is seen upright, by EXIF's number.
STORED: dict[int, Callable[[np.ndarray], np.ndarray]] = {
    1: lambda seen: seen,
    2: lambda seen: seen[:, ::-1],
    3: lambda seen: seen[::-1, ::-1],
    4: lambda seen: seen[::-1],
    5: lambda seen: seen.swapaxes(0, 1),
    6: lambda seen: np.rot90(seen),
    7: lambda seen: seen[::-1, ::-1].swapaxes(0, 1),
    8: lambda seen: np.rot90(seen, -1),
}


@pytest.mark.parametrize("orientation", STORED)
def test_a_picture_is_turned_as_its_camera_was_held_and_its_boxes_back(orientation: int, tmp_path: Path) -> None:
    seen = np.random.default_rng(1).integers(0, 255, (48, 32, 3), np.uint8)
    marked = np.zeros((48, 32), np.uint8)
    marked[10:13, 4:9] = 1
    stored = STORED[orientation](seen)
    (tmp_path / "a.jpg").write_bytes(encoded(stored, orientation=orientation))
    height, width = stored.shape[:2]
    view = Frame("a", tmp_path / "a.jpg", "", 1, calibration=Calibration(30, 30, 16, 16, size=(width, height))).view()
    assert view.image.shape == stored.shape
    assert np.array_equal(view.turn.seen(view.image), Frame("a", tmp_path / "a.jpg", "", 1).view().image)
    assert (view.turn == Turn()) == (orientation == 1)
    rows, columns = np.nonzero(STORED[orientation](marked))
    box = moved((4, 10, 8, 12), view.turn.stored_from_seen(32, 48))
    assert box == (columns.min(), rows.min(), columns.max(), rows.max())


def test_a_calibration_of_the_pixels_as_seen_is_taken_for_that(tmp_path: Path) -> None:
    (tmp_path / "a.jpg").write_bytes(encoded(np.zeros((30, 40, 3), np.uint8), orientation=6))
    view = Frame("a", tmp_path / "a.jpg", "", 1, calibration=Calibration(30, 30, 15, 20, size=(30, 40))).view()
    assert view.image.shape == (40, 30, 3) and view.turn == Turn()


def recorded(path: Path, cache: Path, *arguments: object) -> list[dict[str, Any]]:
    """Play without a server, and return the signs of each keyframe."""
    done = play(*arguments, "--cache", cache, "--no-query", "-o", path, "--every-frame")
    assert done.returncode == 0, done.stderr
    bodies = [json.loads(line)["body"] for line in path.read_text().splitlines() if '"op":"keyframe"' in line.replace(" ", "")]
    return [sign for body in bodies for sign in body.get("detections", [])]


def test_signs_of_a_lying_picture_are_read_upright_and_lie_where_the_camera_has_them(tmp_path: Path) -> None:
    seen = plates("106", "LAB", "204", width=480, height=640)
    upright, lying, cache = tmp_path / "upright", tmp_path / "lying", tmp_path / "cache"
    upright.mkdir()
    (upright / "1.jpg").write_bytes(encoded(np.rot90(seen), orientation=6))
    # The camera of TUM's benchmark is of 640 x 480 pixels, as this picture is stored.
    (lying / "rgb").mkdir(parents=True)
    shutil.copy(upright / "1.jpg", lying / "rgb" / "1.jpg")
    (lying / "rgb.txt").write_text("1.0 rgb/1.jpg\n")
    expected = recorded(tmp_path / "upright.ndjson", cache, "images", upright)
    assert {"106", "LAB"} <= {sign["text"] for sign in expected}
    for kept in (cache, tmp_path / "another"):  # Readings of the upright picture are not those of the lying one.
        signs = recorded(tmp_path / f"{kept.name}.ndjson", kept, "tum", lying)
        assert [sign["text"] for sign in signs] == [sign["text"] for sign in expected]
        for sign, seen_sign in zip(signs, expected):
            x0, y0, x1, y1 = seen_sign["box"]
            assert np.allclose(sign["box"], (y0, 479 - x1, y1, 479 - x0), atol=0.11)
            crop = cv2.imdecode(np.frombuffer(base64.b64decode(sign["crop"]), np.uint8), cv2.IMREAD_COLOR)
            assert crop.shape[1] > 1.5 * crop.shape[0]
    assert len(list(cache.iterdir())) == 2


def test_a_number_below_its_word_is_one_name_however_the_picture_is_stored(tmp_path: Path) -> None:
    seen = np.full((640, 480, 3), 200, np.uint8)
    for text, y in (("GATE", 150), ("7", 220)):
        cv2.putText(seen, text, (100, y), cv2.FONT_HERSHEY_DUPLEX, 2.0, (20, 20, 20), 4, cv2.LINE_AA)
    (tmp_path / "rgb").mkdir()
    (tmp_path / "rgb" / "1.jpg").write_bytes(encoded(np.rot90(seen), orientation=6))
    (tmp_path / "rgb.txt").write_text("1.0 rgb/1.jpg\n")
    signs = recorded(tmp_path / "o.ndjson", tmp_path / "cache", "tum", tmp_path)
    assert {(sign["class"], sign["text"]) for sign in signs} == {("sign", "GATE"), ("name", "GATE 7")}


@pytest.fixture
def tum(one_visit: list[Timed], tmp_path: Path) -> Path:
    return fixtures.tum(tmp_path / "sequence", one_visit)


def test_the_unit_of_depth_images_is_told_with_what_it_makes_of_them(tum: Path, tmp_path: Path) -> None:
    source = opened(tmp_path, "tum", tum, *CAMERA)
    assumed = (
        "assumed: depth images have 5000 units a metre, as TUM's own (--depth-units-per-metre; RealSense and OpenLORIS have 1000): "
        "the median depth is then "
    )
    (line,) = (line for line in source.told() if line.startswith(assumed))
    metres = float(line.removeprefix(assumed).removesuffix(" m"))
    given = opened(tmp_path, "tum", tum, *CAMERA, "--depth-units-per-metre", "1000")
    assert "units a metre" not in told(given)
    depth = [source.frames[0].depth.metres_per_unit, given.frames[0].depth.metres_per_unit]
    assert depth == [1 / 5000, 1 / 1000] and 1 < metres < 10
    with pytest.raises(RevisitError, match=r"1 units a metre: the median depth is then \d+.\d+ m, which cannot be"):
        opened(tmp_path, "tum", tum, "--depth-units-per-metre", "1")
    with pytest.raises(RevisitError, match="--depth-units-per-metre 0.0: a positive number"):
        opened(tmp_path, "tum", tum, "--depth-units-per-metre", "0")


def test_without_a_calibration_the_camera_of_the_benchmark_is_told(tum: Path) -> None:
    done = play("doctor", tum)
    assert done.returncode == 1 and "800 x 600 pixels, but the calibration is of 640 x 480" in done.stderr
    assert "assumed: the benchmark's camera, 525,525,319.5,239.5 (--calibration)" in done.stderr


def test_bad_lines_and_missing_pictures_of_a_tum_list_are_left_out(tum: Path, tmp_path: Path) -> None:
    lines = (tum / "rgb.txt").read_text().splitlines()
    blank = tum / "rgb" / "with two blanks .jpg"
    shutil.copy(tum / lines[1].split()[1], blank)
    lines[1] = lines[1].split()[0] + "  rgb/with two blanks .jpg"
    (tum / lines[2].split()[1]).unlink()
    lines[3] = "yesterday rgb/1.jpg"
    (tum / "rgb.txt").write_bytes(b"\xef\xbb\xbf" + "\r\n".join(lines).encode())
    source = opened(tmp_path, "tum", tum, *CAMERA)
    assert source.frames[0].path == blank and len(source.frames) == 7
    assert f"left out 1: no row of `seconds file`: {tum / 'rgb.txt'}, line 4" in told(source)
    assert f"left out 1: listed, but no such file: {tum / lines[2].split()[1]}" in told(source)
    (tum / "rgb.txt").write_text("nothing\nof this\n")
    with pytest.raises(RevisitError, match="no row of `seconds file` in it"):
        opened(tmp_path, "tum", tum)


def test_a_depth_image_that_cannot_be_read_leaves_its_picture_unmeasured(tum: Path, cache: Path, tmp_path: Path) -> None:
    first, second, third, *_ = sorted((tum / "depth").iterdir())
    first.unlink()
    second.write_bytes(second.read_bytes()[:100])
    cv2.imwrite(str(third), np.zeros((60, 80), np.uint16))
    output = tmp_path / "o.ndjson"
    done = play("tum", tum, *CAMERA, "--cache", cache, "--no-query", "-o", output, "--every-frame")
    assert done.returncode == 0, done.stderr
    for name, why in ((first, "no such file"), (second, "damaged or cut short"), (third, "80 x 60, but its picture is 800 x 600")):
        assert any(str(name) in line and why in line for line in done.stderr.splitlines()), name
    bodies = [json.loads(line)["body"] for line in output.read_text().splitlines()[1::2]]
    measured = [{"range" in sign for sign in body.get("detections", [])} for body in bodies]
    assert len(bodies) == 9 and all(one == {True} for one in measured[:3] if one) and {False} in measured[3:]


def test_lists_of_euroc_are_read_as_excel_and_windows_write_them(one_visit: list[Timed], tmp_path: Path) -> None:
    folder = fixtures.euroc(tmp_path / "MH", one_visit)
    for name in ("cam0", "state_groundtruth_estimate0"):
        file = folder / "mav0" / name / "data.csv"
        file.write_text(file.read_text().replace(",", " ; "), encoding="utf-8-sig")
    sensor = folder / "mav0" / "cam0" / "sensor.yaml"
    sensor.write_text(sensor.read_text(), encoding="utf-8-sig")
    source = opened(tmp_path, "euroc", folder)
    assert len(source.frames) == 9 and not source.left_out.count
    assert all(frame.session_from_camera is not None for frame in source.frames)


def test_bad_rows_of_euroc_are_left_out_with_their_line(one_visit: list[Timed], tmp_path: Path) -> None:
    folder = fixtures.euroc(tmp_path / "MH", one_visit)
    pictures, poses = folder / "mav0" / "cam0" / "data.csv", folder / "mav0" / "state_groundtruth_estimate0" / "data.csv"
    rows = pictures.read_text().splitlines()
    rows[2] = "no row"
    (folder / "mav0" / "cam0" / "data" / rows[3].split(",")[1]).unlink()
    pictures.write_text("\n".join(rows))
    rows = poses.read_text().splitlines()
    rows[1] = rows[1].split(",")[0] + ",nan" * 10
    poses.write_text("\n".join(rows))
    source = opened(tmp_path, "euroc", folder)
    assert len(source.frames) == 7
    assert f"no row of `nanoseconds,file`: {pictures}, line 3" in told(source)
    assert "left out 1: listed, but no such file: " in told(source)
    assert f"no finite numbers: {poses}, line 2" in told(source)
    pictures.write_text("time,name\n")
    with pytest.raises(RevisitError, match="data.csv: no row of `nanoseconds,file` in it"):
        opened(tmp_path, "euroc", folder)


def test_images_that_a_model_has_and_the_folder_lacks_are_left_out(one_visit: list[Timed], tmp_path: Path) -> None:
    model = fixtures.colmap(tmp_path / "model", one_visit[:3])
    lacking = tmp_path / "model" / "images" / one_visit[1].shot.name
    lacking.unlink()
    source = opened(tmp_path, "colmap", model)
    assert len(source.frames) == 2 and f"left out 1: listed, but no such file: {lacking}" in told(source)


def test_photographs_that_are_not_named_by_a_time_are_left_out(one_visit: list[Timed], tmp_path: Path) -> None:
    folder = tmp_path / "photographs"
    folder.mkdir()
    for one in one_visit[:2]:
        (folder / f"{one.stamp_ns}.jpg").write_bytes(one.jpeg)
    (folder / "cover.jpg").write_bytes(one_visit[0].jpeg)
    source = opened(tmp_path, "images", folder, "--trajectory", fixtures.trajectory(tmp_path / "poses.txt", one_visit))
    assert len(source.frames) == 2 and "a photograph's name is its time" in told(source)


def message(image: np.ndarray, encoding: str, **more: Any) -> SimpleNamespace:
    data = np.ascontiguousarray(image)
    said = {"height": image.shape[0], "width": image.shape[1], "step": data.strides[0], "is_bigendian": 0, "data": data.tobytes()}
    return SimpleNamespace(encoding=encoding, **(said | more))


# Two halves of one colour each: red, and a greenish blue.
COLOURS = np.zeros((32, 64, 3), np.uint8)
COLOURS[:, :32], COLOURS[:, 32:] = (20, 30, 220), (200, 120, 10)


def mosaic(pattern: str) -> np.ndarray:
    """Return what a sensor whose first two rows are `pattern` sees of the colours."""
    seen = np.zeros(COLOURS.shape[:2], np.uint8)
    for place, letter in enumerate(pattern):
        row, column = divmod(place, 2)
        seen[row::2, column::2] = COLOURS[row::2, column::2, "bgr".index(letter)]
    return seen


def yuv(luma_first: bool) -> np.ndarray:
    """Return the colours with every second column's hues."""
    y, u, v = np.moveaxis(cv2.cvtColor(COLOURS, cv2.COLOR_BGR2YUV), 2, 0)
    # What is drawn here is of the whole range, as messages are not: hues are compared only.
    hues = np.where(np.arange(y.shape[1]) % 2 == 0, u, v)
    return np.stack((y, hues) if luma_first else (hues, y), axis=2)


def read_back(tmp_path: Path, *messages: SimpleNamespace) -> tuple[list[np.ndarray], LeftOut]:
    left_out, stamped = LeftOut(), [(at * 10**9, one) for at, one in enumerate(messages, 1)]
    recording = SimpleNamespace(file=Path("drive.mcap"), messages=lambda _: stamped, left_out=left_out)
    frames = frames_of(recording, "/camera", None, 0.0, tmp_path)
    return [frame.view().image.astype(int) for frame in frames], left_out


WIDE = COLOURS[:, :, 0].astype("<u2") << 8
ENCODED = {
    **{f"bayer_{pattern}8": mosaic(pattern) for pattern in ("rggb", "bggr", "gbrg", "grbg")},
    "bayer_rggb16": mosaic("rggb").astype("<u2") << 8,
    "rgb8": COLOURS[:, :, ::-1],
    "rgba8": np.dstack((COLOURS[:, :, ::-1], COLOURS[:, :, 0])),
    "bgr16": COLOURS.astype("<u2") << 8,
    "yuv422": yuv(False),
    "yuv422_yuy2": yuv(True),
}


@pytest.mark.parametrize("encoding", ENCODED)
def test_pictures_of_each_encoding_have_their_colours(encoding: str, tmp_path: Path) -> None:
    (image,), left_out = read_back(tmp_path, message(ENCODED[encoding], encoding))
    most = 40 if encoding.startswith("yuv") else 12
    for half, colour in ((slice(8, 24), (20, 30, 220)), (slice(40, 56), (200, 120, 10))):
        assert np.abs(image[8:24, half].mean(axis=(0, 1)) - colour).max() < most, image[16, half.start]
    assert not left_out.count


@pytest.mark.parametrize("order", ["<u2", ">u2"])
def test_grey_pictures_of_16_bits_keep_their_upper_8(order: str, tmp_path: Path) -> None:
    (image,), _ = read_back(tmp_path, message(WIDE.astype(order), "mono16", is_bigendian=int(order == ">u2")))
    assert np.abs(image[16, 16] - 20).max() < 3 and np.abs(image[16, 48] - 200).max() < 3


def test_a_broken_picture_of_a_bag_is_left_out_and_an_unknown_one_names_what_is_known(tmp_path: Path) -> None:
    good = message(COLOURS, "bgr8")
    images, left_out = read_back(tmp_path, good, message(COLOURS, "bgr8", data=b"cut"), message(COLOURS, "nv21"), good)
    assert len(images) == 2
    cut, unknown = left_out.told()
    assert "left out 1: 3 bytes are no picture of 64 x 32 in rows of 192 bytes: drive.mcap, picture 1 of /camera" == cut
    assert "it is nv21; known: " in unknown and all(name in unknown for name in ENCODINGS)


def test_a_bag_with_a_broken_message_is_played_without_it(one_visit: list[Timed], tmp_path: Path) -> None:
    file = fixtures.bag(tmp_path / "drive", one_visit[:3], broken=True)
    source = opened(tmp_path, "bag", file)
    assert len(source.frames) == 3 and "left out 1: a message that rosbags cannot read: /camera/image_raw/compressed at " in told(source)
    assert all(frame.session_from_camera is not None for frame in source.frames)


def test_a_bags_folder_without_metadata_is_read_from_its_pieces(one_visit: list[Timed], tmp_path: Path) -> None:
    folder = tmp_path / "drive"
    file = fixtures.bag(folder, one_visit[:4])
    (folder / "metadata.yaml").unlink()
    (folder / "._drive.mcap").write_bytes(b"\0\5\x16\7")
    assert len(opened(tmp_path, "bag", folder).frames) == 4
    file.rename(folder / "drive_0.mcap")
    fixtures.bag(tmp_path / "more", one_visit[4:6]).rename(folder / "drive_1.mcap")
    assert len(opened(tmp_path, "bag", folder).frames) == 6
    (folder / "drive_1.mcap").rename(folder / "other.mcap")
    with pytest.raises(RevisitError, match="several recordings and no metadata.yaml; name one: drive_0.mcap, other.mcap"):
        opened(tmp_path, "bag", folder)


def test_a_recording_that_was_not_closed_is_refused_with_the_next_step(one_visit: list[Timed], tmp_path: Path) -> None:
    data = fixtures.bag(tmp_path / "drive", one_visit[:2]).read_bytes()
    (tmp_path / "no recording").mkdir()
    (tmp_path / "bad").mkdir()
    (tmp_path / "bad" / "metadata.yaml").write_text("{}")
    cases = {
        "killed.mcap": (data[: len(data) // 2], "`mcap recover {0} -o"),
        "drive.bag.active": (b"#ROSBAG V2.0\n", "`rosbag reindex {0}`"),
        "cut.bag": (b"#ROSBAG V2.0\n" + bytes(40), "`rosbag reindex {0}`"),
        "drive.mcap.zstd": (zstandard.compress(data), "unpack it (`zstd -d`)"),
        "page.mcap": (b"<!DOCTYPE html>", "a web page"),
        "no recording": (None, "no recording in it (metadata.yaml, .mcap, .db3, .bag)"),
        "bad": (None, "`ros2 bag reindex {0}`"),
    }
    for name, (content, step) in cases.items():
        if content is not None:
            (tmp_path / name).write_bytes(content)
        with pytest.raises(RevisitError) as error:
            opened(tmp_path, "bag", tmp_path / name)
        assert step.format(tmp_path / name) in str(error.value) and "\n" not in str(error.value), name


def test_a_film_says_what_it_lacks(one_visit: list[Timed], tmp_path: Path) -> None:
    film = fixtures.film(tmp_path / "walk.avi", one_visit)
    data = film.read_bytes()
    film.write_bytes(data[: len(data) // 2])
    source = opened(tmp_path, "video", film, "--every-s", "0")
    assert f"left out {18 - len(source.frames)}: pictures of the 18 that it announces cannot be read: {film}" in told(source)
    (tmp_path / "film.mp4").write_bytes(b"<!DOCTYPE html>")
    with pytest.raises(RevisitError, match="not a film that OpenCV reads, but a web page"):
        opened(tmp_path, "video", tmp_path / "film.mp4")


def doctored(path: Path, capsys: pytest.CaptureFixture[str]) -> tuple[int, str]:
    status = main(["doctor", str(path)])
    captured = capsys.readouterr()
    return status, captured.out + captured.err


def test_the_doctor_knows_each_form_and_the_command_that_plays_it(
    one_visit: list[Timed], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    few = one_visit[:2]
    (tmp_path / "photographs").mkdir()
    (tmp_path / "photographs" / "1.jpg").write_bytes(few[0].jpeg)
    (tmp_path / "photographs" / "2.jpg").write_bytes(few[0].jpeg[:500])
    (tmp_path / "house.building.yaml").write_text(BUILDING)
    bag = fixtures.bag(tmp_path / "drive", few)
    cases = {
        fixtures.euroc(tmp_path / "MH", few): ("euroc", "reads 2 pictures; poses: the ground truth of"),
        fixtures.colmap(tmp_path / "model", few): ("colmap", "reads 2 pictures; poses: the model's; distances of signs: those of"),
        bag.parent: ("bag", "reads 2 pictures; poses: odometry on /odom"),
        bag: ("bag", "assumed: a picture every 0.5 s is enough (--every-s)"),
        fixtures.film(tmp_path / "walk.avi", few): ("video", "reads 4 pictures"),
        tmp_path / "photographs": ("images", "it is a JPEG picture, damaged or cut short: "),
        tmp_path / "house.building.yaml": ("plan", " signs of level G"),
        foreign_maps.rtabmap(tmp_path / "map.db", foreign_world.world()): ("import", "keyframes of RTAB-Map"),
        foreign_maps.stella_packed(tmp_path / "map.msg", foreign_world.world()): ("import", "keyframes of stella_vslam"),
    }
    for path, (command, words) in cases.items():
        status, printed = doctored(path, capsys)
        assert status == 0, printed
        assert words in printed and f"now: revisit-play {command} {path}" in printed, printed
    assert "reads 1 pictures" in doctored(tmp_path / "photographs", capsys)[1]


def test_the_doctor_says_what_a_model_without_its_pictures_is_good_for(
    one_visit: list[Timed], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    model = fixtures.colmap(tmp_path / "model", one_visit[:2])
    shutil.rmtree(tmp_path / "model" / "images")
    status, printed = doctored(model, capsys)
    assert status == 0 and "not read by `colmap`: " in printed and f"now: revisit-play import {model} -o" in printed


def test_the_doctor_ends_with_1_where_nothing_can_be_read(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "empty").mkdir()
    (tmp_path / "a.zip").write_bytes(b"PK\3\4")
    cases = {"empty": "no photographs in it", "a.zip": "a zip archive: unpack it", "none": "none: no such file"}
    for name, words in cases.items():
        status, printed = doctored(tmp_path / name, capsys)
        assert status == 1 and words in printed and printed.count("\n") == 1, printed
