"""revisit-play from other systems' files, through its command line: what a source tells arrives in the keyframes."""

import json
import os
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

cv2 = pytest.importorskip("cv2")
pytest.importorskip("rapidocr")
pytest.importorskip("rosbags")
pytest.importorskip("pycolmap")

import fixtures  # noqa: E402
from fixtures import Timed  # noqa: E402
from test_play import play  # noqa: E402

from revisit_slam.pixels.camera import Calibration  # noqa: E402
from revisit_slam.pixels.rotations import rotation  # noqa: E402


@pytest.fixture(scope="session")
def walked() -> list[Timed]:
    return fixtures.timed()


@pytest.fixture(scope="session")
def one_visit() -> list[Timed]:
    return fixtures.timed("1")


@pytest.fixture(scope="session")
def cache(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return Path(os.environ.get("REVISIT_SAMPLE_READINGS") or tmp_path_factory.mktemp("readings"))


def recorded(source: str, path: Path, cache: Path, *more: object) -> tuple[dict, dict[str, dict]]:
    """Play without a server; return the map's body and each keyframe's."""
    output = path.parent / f"{source}.ndjson"
    done = play(source, path, "--cache", cache, "--no-query", "-o", output, "--no-crops", *more)
    assert done.returncode == 0, done.stderr
    lines = [json.loads(line) for line in output.read_text().splitlines()]
    bodies = {line["id"]: line["body"] for line in lines if line["op"] == "keyframe"}
    assert bodies
    return lines[0]["body"], bodies


def pose_of(body: dict) -> np.ndarray:
    pose = np.eye(4)
    pose[:3, :3] = rotation(np.array([body["pose"]["rotation"][axis] for axis in "xyzw"]))
    pose[:3, 3] = [body["pose"]["translation"][axis] for axis in "xyz"]
    return pose


def assert_posed(bodies: dict[str, dict], walked: list[Timed], start_ns: int = 0) -> None:
    """Every keyframe stands where its photograph was taken."""
    at = {one.stamp_ns - start_ns: one.shot.building_from_camera for one in walked}
    for id, body in bodies.items():
        stamp_ns = body["stamp"]["sec"] * fixtures.SECOND_NS + body["stamp"]["nanosec"]
        assert np.allclose(pose_of(body), at[stamp_ns], atol=1e-5), id
    assert len({body["session"] for body in bodies.values()}) == 1


def spread_m(bodies: dict[str, dict]) -> list[float]:
    """How far each sighting of a door's plate is from the middle of its sightings, in metres."""
    places: dict[str, list[list[float]]] = {}
    for body in bodies.values():
        for seen in body.get("detections", []):
            if "range" not in seen and seen["confidence"] >= 0.9 and seen["text"].isdigit():
                places.setdefault(seen["text"], []).append(seen["position"])
    apart = [np.linalg.norm(np.array(p) - np.median(p, axis=0), axis=1) for p in places.values() if len(p) >= 2]
    assert len(apart) >= 3
    return list(np.concatenate(apart))


def test_tum_measures_signs_by_depth_and_every_loop_is_right(walked: list[Timed], cache: Path, tmp_path: Path) -> None:
    folder = fixtures.tum(tmp_path / "sequence", walked)
    output = tmp_path / "tum.ndjson"
    arguments = ("--cache", cache, "--truth", folder / "truth.csv", "--json", "-o", output, "--calibration", "600,600,400,300")
    done = play("tum", folder, *arguments)
    assert done.returncode == 0, done.stderr
    figures = json.loads(done.stdout)
    assert figures["wrong"] == figures["loops_wrong"] == 0 and figures["right"] >= 5, figures
    lines = [json.loads(line) for line in output.read_text().splitlines()]
    bodies = {line["id"]: line["body"] for line in lines if line["op"] == "keyframe"}
    assert_posed(bodies, walked)
    assert max(spread_m(bodies)) < 0.3


def test_with_features_a_depth_image_gives_each_its_point(one_visit: list[Timed], cache: Path, tmp_path: Path) -> None:
    folder = fixtures.tum(tmp_path / "sequence", one_visit)
    _, bodies = recorded("tum", folder, cache, "--calibration", "600,600,400,300", "--features")
    for body in bodies.values():
        named = [id for id in body["features"]["map_points"] if id >= 0]
        assert named == body["map_points"]["ids"] and len(named) > 100
        # The keypoint of a point is where the point is seen.
        pixels = [p for p, id in zip(body["features"]["keypoints"], body["features"]["map_points"]) if id >= 0]
        seen = (np.array(body["map_points"]["positions"]) - pose_of(body)[:3, 3]) @ pose_of(body)[:3, :3]
        projected = seen[:, :2] / seen[:, 2:] * 600 + (400, 300)
        assert np.abs(projected - np.array(pixels)[:, :2]).max() < 0.1


def test_euroc_places_the_camera_by_the_body(walked: list[Timed], cache: Path, tmp_path: Path) -> None:
    folder = fixtures.euroc(tmp_path / "MH_99", walked)
    about, bodies = recorded("euroc", folder, cache, "--every-s", "0")
    assert about["metric"] is True
    assert_posed(bodies, walked)
    assert set(bodies) <= {str(one.stamp_ns) for one in walked}
    detections = [seen for body in bodies.values() for seen in body.get("detections", [])]
    assert {seen["range"] for seen in detections} == {"assumed"}


def test_colmap_measures_signs_by_the_points_around_them(walked: list[Timed], cache: Path, tmp_path: Path) -> None:
    model = fixtures.colmap(tmp_path / "model", walked, metres_per_unit=2.0)
    about, bodies = recorded("colmap", model, cache, "--metres-per-unit", "2")
    assert about["metric"] is True
    poses = {one.shot.name[:-4]: one.shot.building_from_camera for one in walked}
    for id, body in bodies.items():
        assert np.allclose(pose_of(body), poses[id], atol=1e-5), id
        assert body["observes"] == body["map_points"]["ids"] and len(body["observes"]) == 1200
        assert (body["camera"]["cx"], body["camera"]["cy"]) == (400, 300)
    assert max(spread_m(bodies)) < 0.3
    about, bodies = recorded("colmap", model, cache)
    assert about["metric"] is False


@pytest.mark.parametrize("raw", [False, True])
def test_a_bag_has_its_odometry_its_camera_and_where_it_sits(raw: bool, one_visit: list[Timed], cache: Path, tmp_path: Path) -> None:
    file = fixtures.bag(tmp_path / "drive", one_visit, raw=raw)
    _, bodies = recorded("bag", file, cache, "--every-s", "0")
    assert_posed(bodies, one_visit)
    assert {body["camera"]["fx"] for body in bodies.values()} == {600}
    assert all(id.startswith(f"{file.stem}-00000") for id in bodies)


def test_a_bag_whose_camera_nothing_joins_to_the_odometry_says_so(one_visit: list[Timed], cache: Path, tmp_path: Path) -> None:
    file = fixtures.bag(tmp_path / "drive", one_visit, joined=False)
    done = play("bag", file, "--cache", cache, "--no-query", "-o", tmp_path / "bag.ndjson")
    assert done.returncode == 0 and "nothing on /tf_static joins it to the camera's optical" in done.stdout
    bodies = [json.loads(line)["body"] for line in (tmp_path / "bag.ndjson").read_text().splitlines()[1:] if "body" in line]
    assert all(body["pose"]["translation"] == {"x": 0, "y": 0, "z": 0} for body in bodies if "pose" in body)


@pytest.mark.parametrize("what", ["rectified", "late", "without stamps", "not calibrated"])
def test_a_bag_of_another_kind_is_played_whole(what: str, one_visit: list[Timed], cache: Path, tmp_path: Path) -> None:
    order = one_visit[3:] + one_visit[:3] if what == "late" else one_visit
    more = {"rectified": {"topic_name": "image_rect"}, "without stamps": {"stamped": False}, "not calibrated": {"focal_px": 0.0}}
    file = fixtures.bag(tmp_path / "drive", order, **more.get(what, {}))
    _, bodies = recorded("bag", file, cache, "--every-s", "0", "--every-frame")
    assert len(bodies) == len(one_visit)
    assert_posed(bodies, one_visit)
    # What nobody calibrated is guessed, and the guess is 0.75 of the longer side: here the same.
    assert {body["camera"]["fx"] for body in bodies.values()} == {600}


def test_depth_without_a_pose_measures_nothing(one_visit: list[Timed], cache: Path, tmp_path: Path) -> None:
    folder = fixtures.tum(tmp_path / "sequence", one_visit)
    (folder / "groundtruth.txt").unlink()
    _, bodies = recorded("tum", folder, cache, "--calibration", "600,600,400,300", "--features")
    assert {seen["range"] for body in bodies.values() for seen in body.get("detections", [])} == {"assumed"}
    assert not any("map_points" in body for body in bodies.values())


def test_pictures_listed_twice_are_played_once(one_visit: list[Timed], cache: Path, tmp_path: Path) -> None:
    folder = fixtures.tum(tmp_path / "sequence", one_visit)
    (folder / "rgb.txt").write_text((folder / "rgb.txt").read_text() * 2)
    arguments = ("--calibration", "600,600,400,300", "--cache", cache, "--every-s", "0", "--every-frame", "--no-query")
    done = play("tum", folder, *arguments, "-o", tmp_path / "o.ndjson")
    assert done.returncode == 0 and "left out 9: listed twice: " in done.stderr, done.stderr
    ids = [json.loads(line)["id"] for line in (tmp_path / "o.ndjson").read_text().splitlines()[1::2]]
    assert len(ids) == len(set(ids)) == len(one_visit)


def test_a_truth_names_photographs_of_two_folders_by_their_path(one_visit: list[Timed], tmp_path: Path) -> None:
    from revisit_slam.errors import RevisitError
    from revisit_slam.pixels.frames import list_frames
    from revisit_slam.pixels.truth import Truth

    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "0001.jpg").write_bytes(one_visit[0].jpeg)
    frames = list_frames(tmp_path)
    named = [("a/0001.jpg", "upper"), ("b/0001.jpg", "lower")]
    assert not Truth(fixtures.truth(tmp_path, named), frames).same_floor("a.0001", "b.0001")
    with pytest.raises(RevisitError, match="no floor"):
        Truth(fixtures.truth(tmp_path, [("c/0001.jpg", "upper"), ("b/0001.jpg", "lower")]), frames)


def test_a_model_of_pictures_held_upright_is_of_their_stored_pixels(cache: Path, tmp_path: Path) -> None:
    from PIL import Image

    from revisit_slam.pixels.frames import Frame

    turned = tmp_path / "turned.jpg"
    exif = Image.Exif()
    exif[0x0112] = 6
    Image.fromarray(np.zeros((30, 40, 3), np.uint8)).save(turned, exif=exif)
    known = Calibration(30.0, 30.0, 20.0, 15.0, size=(40, 30))
    assert Frame("t", turned, "", 1, calibration=known).view().image.shape == (30, 40, 3)
    assert Frame("t", turned, "", 1).view().image.shape == (40, 30, 3)


def test_a_fisheye_lens_without_terms_still_bends() -> None:
    found = Calibration(600.0, 600.0, 400.0, 300.0, (), True).undistorted_pixels(np.array([[700.0, 300.0]]))
    assert abs(found[0, 0] - (400 + 600 * np.tan(0.5))) < 0.01


def test_a_time_in_a_name_is_taken_in_its_unit() -> None:
    from revisit_slam.pixels.stamps import named_time_ns

    for name in ("1700000000.25", "1700000000250", "1700000000250000", "1700000000250000000"):
        assert named_time_ns(name) == 1_700_000_000_250_000_000, name
    assert [named_time_ns(name) for name in ("1700000000", "12.5", "7")] == [1_700_000_000 * 10**9, 12_500_000_000, 7 * 10**9]


def test_a_film_gives_a_picture_at_even_times(one_visit: list[Timed], cache: Path, tmp_path: Path) -> None:
    film = fixtures.film(tmp_path / "walk.avi", one_visit)
    poses = fixtures.trajectory(tmp_path / "poses.txt", one_visit, fixtures.START_NS)
    _, bodies = recorded("video", film, cache, "--every-s", "1", "--trajectory", poses, "--every-frame")
    # Every second picture of the film is black.
    assert list(bodies) == [f"walk-{number:06}" for number in range(0, 2 * len(one_visit), 2)]
    assert_posed(bodies, one_visit, fixtures.START_NS)
    assert any(seen["text"] == "102" for body in bodies.values() for seen in body.get("detections", []))


def test_photographs_named_by_their_time_take_poses_from_a_trajectory(
    one_visit: list[Timed], cache: Path, tmp_path: Path
) -> None:
    folder = tmp_path / "photographs"
    folder.mkdir()
    for one in one_visit:
        (folder / f"{one.stamp_ns}.jpg").write_bytes(one.jpeg)
    poses = fixtures.trajectory(tmp_path / "poses.txt", one_visit[2:])
    output = tmp_path / "o.ndjson"
    done = play("images", folder, "--cache", cache, "--no-query", "-o", output, "--trajectory", poses)
    assert done.returncode == 0 and "left out 2: no pose near its time: poses from " in done.stderr
    lines = [json.loads(line) for line in output.read_text().splitlines()]
    assert_posed({line["id"]: line["body"] for line in lines if line["op"] == "keyframe"}, one_visit)


def test_equal_pictures_may_be_read_at_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from revisit_slam.pixels.reader import Reader

    monkeypatch.setattr(Reader, "_look", lambda *_: [])
    threads, rounds = 8, 100
    together = threading.Barrier(threads, timeout=20)

    def read(_: int) -> int:
        for number in range(rounds):
            together.wait()
            assert Reader(tmp_path).read(b"%d" % number, np.zeros((1, 1, 3))) == []
        return rounds

    with ThreadPoolExecutor(threads) as pool:
        assert list(pool.map(read, range(threads))) == [rounds] * threads
    assert len(list(tmp_path.iterdir())) == rounds


def test_a_distorted_picture_is_straightened_as_its_points_are() -> None:
    for fisheye, distortion in ((False, (-0.28, 0.07, 0.0002, 0.00002)), (True, (-0.01, 0.02, -0.01, 0.003))):
        calibration = Calibration(300.0, 310.0, 250.0, 180.0, distortion, fisheye, (500, 360))
        image = np.zeros((360, 500), np.uint8)
        cv2.circle(image, (420, 60), 3, 255, -1)
        straight = calibration.undistorted(image)
        rows, columns = np.nonzero(straight > 100)
        found = calibration.undistorted_pixels(np.array([[420.0, 60.0]]))[0]
        assert np.hypot(columns.mean() - found[0], rows.mean() - found[1]) < 0.5
        assert np.hypot(*(found - (420, 60))) > 1


def test_a_real_colmap_model_is_read(cache: Path, tmp_path: Path) -> None:
    shared = os.environ.get("REVISIT_SHARED")
    if not shared:
        pytest.skip("needs REVISIT_SHARED")
    output = tmp_path / "o.ndjson"
    done = play("colmap", Path(shared) / "samples/colmap/reconstruction", "--cache", cache, "--no-query", "-o", output, "--every-frame")
    assert done.returncode == 0, done.stderr
    bodies = [json.loads(line)["body"] for line in output.read_text().splitlines()[1::2]]
    # The model's own figures: 4 images, 1,039 points, 3,355 observations, of which 5 are of a point seen twice in one image.
    assert len(bodies) == 4
    assert sum(len(body["map_points"]["ids"]) for body in bodies) == 1039
    assert sum(len(body["observes"]) for body in bodies) == 3350


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("video", "{tmp}/no.mp4"), "no.mp4: no such file"),
        (("video", "{tmp}/text.mp4"), "text.mp4: not a film that OpenCV reads"),
        (("tum", "{tmp}"), "rgb.txt: cannot be read"),
        (("tum", "{tmp}/tum"), "640 x 480"),
        (("tum", "{tmp}/tum", "--calibration", "1,2,3"), "--calibration 1,2,3: FX,FY,CX,CY"),
        (("tum", "{tmp}/tum", "--every-s", "-1"), "--every-s -1"),
        (("images", "{tmp}/named", "--calibration", "6,6,4,3", "--focal-px", "6"), "--focal-px: --calibration tells it"),
        (("tum", "{tmp}/tum", "--trajectory", "{tmp}/text.mp4"), "text.mp4, line 1: no line of `seconds x y z"),
        (("tum", "{tmp}/tum", "--trajectory", "{tmp}/early.txt"), "no pose near its time: poses from 1.000 to"),
        (("euroc", "{tmp}"), "sensor.yaml: cannot be read"),
        (("colmap", "{tmp}"), "no COLMAP model in it"),
        (("colmap", "{tmp}/broken"), "pycolmap cannot read the model"),
        (("bag", "{tmp}/no.mcap"), "no.mcap: no such file"),
        (("bag", "{tmp}/text.mcap"), "rosbags cannot read it"),
        (("tum", "{tmp}/tum", "--calibration", "nan,6,4,3"), "--calibration nan,6,4,3: FX,FY,CX,CY"),
        (("tum", "{tmp}/tum", "--calibration", "600,600,4000,300"), "the camera's centre is at 4000, 300"),
        (("euroc", "{tmp}/fx"), "sensor.yaml: a camera of focal length 0"),
        (("euroc", "{tmp}/terms"), "sensor.yaml: 3 terms of distortion"),
        (("euroc", "{tmp}/mirrored"), "sensor.yaml: T_BS is no rotation"),
        (("images", "{tmp}/named", "-o", "{tmp}/broken"), "a folder is there"),
        (("images", "{tmp}/named", "--trajectory", "{tmp}/early.txt"), "a photograph's name is its time"),
    ],
)
def test_a_bad_source_is_one_clear_line(arguments: tuple[str, ...], told: str, one_visit: list[Timed], tmp_path: Path) -> None:
    (tmp_path / "text.mp4").write_text("no film")
    (tmp_path / "text.mcap").write_text("no bag")
    (tmp_path / "early.txt").write_text("1 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 1\n")
    (tmp_path / "broken").mkdir()
    for name in ("cameras", "images", "points3D"):
        (tmp_path / "broken" / f"{name}.txt").write_text("1 NOTHING x\n")
    (tmp_path / "named").mkdir()
    (tmp_path / "named" / "door.jpg").write_bytes(one_visit[0].jpeg)
    fixtures.tum(tmp_path / "tum", one_visit[:2])
    for name, old, new in (
        ("fx", "intrinsics: [600.0,", "intrinsics: [0.0,"),
        ("terms", "[0.0, 0.0, 0.0, 0.0]\n", "[0.0, 0.0, 0.1]\n"),
        ("mirrored", "-1.0, 0.0, 0.0, 0.05", "1.0, 0.0, 0.0, 0.05"),
    ):
        sensor = fixtures.euroc(tmp_path / name, one_visit[:1]) / "mav0/cam0/sensor.yaml"
        assert old in sensor.read_text(), name
        sensor.write_text(sensor.read_text().replace(old, new))
    output = () if "-o" in arguments else ("-o", str(tmp_path / "o.ndjson"))
    done = play(*(argument.format(tmp=tmp_path) for argument in arguments), "--no-query", *output)
    assert done.returncode == 1, done.stdout
    assert told in done.stderr and done.stderr.count("\n") == 1, done.stderr
