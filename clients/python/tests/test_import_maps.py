"""revisit-play import of RTAB-Map, stella_vslam and MapData: synthetic maps in their own schemas, and real recordings without a map."""

import json
import sqlite3
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from imported import Imported, column, features_of, imported, observes, pose_of, projected, refused, shared

msgpack = pytest.importorskip("msgpack")
pytest.importorskip("rosbags")

import foreign_maps  # noqa: E402
import foreign_messages  # noqa: E402
from foreign_maps import DRIFT, STELLA_STEP  # noqa: E402
from foreign_world import FX, World, placed, turn, world  # noqa: E402
from mcap_records import counts  # noqa: E402

from revisit_slam import Client, Server  # noqa: E402
from revisit_slam.play import main  # noqa: E402
from revisit_slam.server import find_binary  # noqa: E402

# Of 32-bit floats at ten metres, and of their pixels.
FLOAT_M, FLOAT_PX = 2e-6, 2e-3


@pytest.fixture(scope="module")
def drive() -> World:
    return world()


def assert_drive(found: Imported, drive: World, names: list[str], tolerance_m: float, last_first: bool = False) -> None:
    """Cameras stand where the drive put them, at their times, and see their points where their features are."""
    assert list(found.keyframes) == names
    points = found.points()
    for stand, body in zip(drive.stands, found.keyframes.values()):
        assert np.abs(pose_of(body) - stand.map_from_camera).max() < tolerance_m
        assert body["stamp"]["sec"] + body["stamp"]["nanosec"] / 1e9 == pytest.approx(stand.stamp_s, abs=1e-6)
        keypoints, ids, descriptors = features_of(body)
        if last_first:
            keypoints, ids, descriptors = keypoints[::-1], ids[::-1], descriptors[::-1]
        assert np.abs(keypoints[:, :2] - stand.pixels).max() < 1e-3
        assert np.array_equal(descriptors, drive.descriptors[stand.seen])
        assert np.array_equal(keypoints[:, 2], stand.seen % 8) and np.allclose(keypoints[:, 3], drive.angles_deg[stand.seen])
        named = ids >= 0
        assert named.sum() > 10
        seen = projected(body, np.array([points[body["session"], int(id)] for id in ids[named]]))
        assert np.abs(seen - keypoints[named, :2]).max() < FLOAT_PX


def assert_rtabmap(found: Imported, drive: World, name: str, last_first: bool = False) -> None:
    """The drive, with RTAB-Map's words, neighbours and loop."""
    names = [f"{name}-0-{stand.number + 1}" for stand in drive.stands]
    assert_drive(found, drive, names, FLOAT_M, last_first)
    assert found.map["metric"] is True
    assert found.loops == [(names[-1], names[0])]
    for stand, body in zip(drive.stands, found.keyframes.values()):
        words = column(body["bow"], "words", "words_u32", "<u4")
        assert words.tolist() == (stand.seen + 1).tolist() and body["bow"]["vocabulary"] == f"rtabmap:{name}"
    for before, stand, body in zip(drive.stands, drive.stands[1:], list(found.keyframes.values())[1:]):
        common = len(np.intersect1d(before.seen, stand.seen))
        assert body["covisible"] == [{"keyframe": names[before.number], "shared": common}]


def test_an_rtabmap_database_has_its_optimised_poses_words_links_and_points(
    drive: World, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    found = imported(foreign_maps.rtabmap(tmp_path / "office.db", drive), tmp_path, capsys)
    assert_rtabmap(found, drive, "office")
    assert "between keyframes" in found.told and "without an optimised pose" in found.told
    assert {body["camera"]["fx"] for body in found.keyframes.values()} == {FX}


def test_a_tag_is_a_detection_where_it_hangs_in_the_map_and_in_the_picture(
    drive: World, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    found = imported(foreign_maps.rtabmap(tmp_path / "office.db", drive), tmp_path, capsys)
    first, *others = found.keyframes.values()
    assert not any("detections" in body for body in others)
    (seen,) = first["detections"]
    assert (seen["class"], seen["text"]) == ("landmark", str(foreign_maps.TAG))
    place = foreign_maps.TAG_IN_MAP[:3, 3]
    assert np.abs(np.array(seen["position"]) - place).max() < FLOAT_M
    x0, y0, x1, y1 = seen["box"]
    assert np.abs(projected(first, place[None])[0] - ((x0 + x1) / 2, (y0 + y1) / 2)).max() < FLOAT_PX


@pytest.mark.parametrize(("written_m", "expected_m"), [(0.3, 0.3), (None, 0.16), (0.0, 0.16), (99.0, 0.16), (float("nan"), 0.16)])
def test_the_box_of_a_tag_is_as_large_as_its_link_says(
    written_m: float | None, expected_m: float, drive: World, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    found = imported(foreign_maps.rtabmap(tmp_path / "office.db", drive, side_m=written_m), tmp_path, capsys)
    first, *_ = found.keyframes.values()
    x0, y0, x1, y1 = first["detections"][0]["box"]
    depth_m = (np.linalg.inv(pose_of(first)) @ foreign_maps.TAG_IN_MAP)[2, 3]
    assert (x1 - x0, y1 - y0) == pytest.approx((expected_m * FX / depth_m,) * 2, abs=FLOAT_PX)


def test_counts_are_printed_for_a_program(drive: World, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = foreign_maps.stella(tmp_path / "hall.db", drive)
    assert main(["import", str(path), "-o", str(tmp_path / "o.ndjson"), "--json", "--set", "candidates_max=5"]) == 0
    figures = json.loads(capsys.readouterr().out)
    features = sum(len(stand.seen) for stand in drive.stands)
    assert (figures["keyframes"], figures["features"], figures["loops"]) == (len(drive.stands), features, 1)
    assert json.loads((tmp_path / "o.ndjson").read_text().splitlines()[0])["body"]["settings"] == {"candidates_max": 5}


def test_without_optimised_poses_those_of_odometry_count(drive: World, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    found = imported(foreign_maps.rtabmap(tmp_path / "office.db", drive, optimised=False), tmp_path, capsys)
    assert "they are those of odometry" in found.told
    for stand, body in zip(drive.stands, found.keyframes.values()):
        assert np.abs(pose_of(body) - DRIFT @ stand.map_from_camera).max() < FLOAT_M


def test_a_session_that_the_optimised_graph_does_not_join_has_odometrys_poses(
    drive: World, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    found = imported(foreign_maps.rtabmap(tmp_path / "office.db", drive, earlier=2), tmp_path, capsys)
    assert "not joined with the optimised graph, and of odometry's poses: office-0\n" in found.told
    assert [body["session"] for body in found.keyframes.values()] == ["office-0"] * 2 + ["office-1"] * 4
    for stand, body in zip(drive.stands, found.keyframes.values()):
        moved = DRIFT if stand.number < 2 else np.eye(4)
        assert np.abs(pose_of(body) - moved @ stand.map_from_camera).max() < FLOAT_M
    assert found.loops == [("office-1-6", "office-1-3")]


@pytest.mark.parametrize("form", ["rtabmap", "map_data"])
@pytest.mark.parametrize("between", [(2,), (3, 4), (2, 3, 5)])
def test_keyframes_are_covisible_across_the_nodes_between_them(
    between: tuple[int, ...], form: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    # So slow that it sees points again two stands later.
    drive = world(stands=24)
    if form == "rtabmap":
        path = foreign_maps.rtabmap(tmp_path / "office.db", drive)
        with sqlite3.connect(path) as database:
            database.executemany("update Node set weight = -1 where id = ?", [(id,) for id in between])
    else:
        path = foreign_messages.map_data(tmp_path / "office", drive, between=between)
    found = imported(path, tmp_path, capsys)
    stands = [stand for stand in drive.stands if stand.number + 1 not in between]
    assert list(found.keyframes) == [f"office-0-{stand.number + 1}" for stand in stands]
    for before, stand in zip(stands, stands[1:]):
        common = len(np.intersect1d(before.seen, stand.seen))
        assert common > 0 or stand.number > 6
        expected = [{"keyframe": f"office-0-{before.number + 1}", "shared": common}]
        assert found.keyframes[f"office-0-{stand.number + 1}"]["covisible"] == expected


@pytest.mark.parametrize(("calibration", "version"), [("stereo", "0.20.0"), ("floats", "0.17.6")])
def test_calibrations_of_other_forms_are_read(
    calibration: str, version: str, drive: World, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    blob = foreign_maps.stereo_calibration() if calibration == "stereo" else foreign_maps.floats_calibration()
    found = imported(foreign_maps.rtabmap(tmp_path / "office.db", drive, calibration=blob, version=version), tmp_path, capsys)
    assert_rtabmap(found, drive, "office")


NOT_BINARY = "no binary descriptors, or none of a length that is taken"


@pytest.mark.parametrize(
    ("written", "change", "why"),
    [
        ({"binary": False}, "", NOT_BINARY),
        ({}, "update Feature set descriptor_size = 0, descriptor = null", NOT_BINARY),
        ({}, "update Feature set descriptor_size = 3, descriptor = x'010203'", NOT_BINARY),
        ({}, "update Data set calibration = null", "no size of its camera"),
        ({"calibration": foreign_maps.mono_calibration(width=0)}, "", "no size of its camera"),
    ],
)
def test_words_stay_where_there_are_no_features_and_a_note_says_why(
    written: dict[str, Any], change: str, why: str, drive: World, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = foreign_maps.rtabmap(tmp_path / "office.db", drive, **written)
    with sqlite3.connect(path) as database:
        database.execute(change)
    found = imported(path, tmp_path, capsys)
    assert f"{len(drive.stands)} keyframes have words, but no features: {why}\n" in found.told
    for stand, body in zip(drive.stands, found.keyframes.values()):
        assert "features" not in body
        assert column(body["bow"], "words", "words_u32", "<u4").tolist() == (stand.seen + 1).tolist()


@pytest.mark.parametrize(
    ("calibration", "version"),
    [
        (2 * foreign_maps.mono_calibration(), "0.21.4"),
        (2 * foreign_maps.stereo_calibration(), "0.21.4"),
        (3 * foreign_maps.stereo_calibration(), "0.21.4"),
        (2 * foreign_maps.floats_calibration(), "0.17.6"),
    ],
)
def test_several_cameras_side_by_side_send_the_first_ones_features(
    calibration: bytes, version: str, drive: World, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = foreign_maps.rtabmap(tmp_path / "office.db", drive, calibration=calibration, version=version)
    with sqlite3.connect(path) as database:
        database.execute("update Feature set pos_x = pos_x + 640 where word_id % 2 = 0")
    found = imported(path, tmp_path, capsys)
    assert f"of {len(drive.stands)} keyframes with several cameras only the first camera's features are taken\n" in found.told
    for stand, body in zip(drive.stands, found.keyframes.values()):
        keypoints, _, _ = features_of(body)
        assert np.abs(keypoints[:, :2] - stand.pixels[(stand.seen + 1) % 2 == 1]).max() < 1e-3


@pytest.mark.parametrize("form", ["sqlite", "msgpack"])
def test_a_stella_map_has_its_poses_features_landmarks_and_loop(
    form: str, drive: World, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "hall.x"
    (foreign_maps.stella if form == "sqlite" else foreign_maps.stella_packed)(path, drive)
    found = imported(path, tmp_path, capsys)
    names = [f"hall-{STELLA_STEP * stand.number}" for stand in drive.stands]
    assert_drive(found, drive, names, 1e-9)
    assert found.loops == [(names[-1], names[0])] and found.map["metric"] is True
    for (_, id), position in found.points().items():
        assert np.abs(position - drive.points[id]).max() < 1e-9
    for stand, body in zip(drive.stands, found.keyframes.values()):
        _, ids, _ = features_of(body)
        assert ids.tolist() == [-1 if at % 4 == 0 else int(point) for at, point in enumerate(stand.seen)]


def test_both_forms_of_a_stella_map_become_one_recording(drive: World, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    one = imported(foreign_maps.stella(tmp_path / "a.db", drive), tmp_path, capsys, "--session", "s", name="one.ndjson")
    other = imported(foreign_maps.stella_packed(tmp_path / "a.msg", drive), tmp_path, capsys, "--session", "s", name="other.ndjson")
    assert one.loops == other.loops and one.keyframes.keys() == other.keyframes.keys()
    for id, body in one.keyframes.items():
        assert np.abs(pose_of(body) - pose_of(other.keyframes[id])).max() < 1e-12
        assert {name: value for name, value in body.items() if name != "pose"} == {
            name: value for name, value in other.keyframes[id].items() if name != "pose"
        }


def test_a_length_of_the_unit_scales_what_one_camera_measured(drive: World, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = foreign_maps.stella(tmp_path / "hall.db", drive, setup="Monocular")
    found = imported(path, tmp_path, capsys)
    assert found.map["metric"] is False and "one camera measures no length" in found.told
    scaled = imported(path, tmp_path, capsys, "--metres-per-unit", "3")
    assert scaled.map["metric"] is True
    for one, other in zip(found.keyframes.values(), scaled.keyframes.values()):
        assert np.abs(pose_of(one)[:3, :3] - pose_of(other)[:3, :3]).max() == 0
        assert np.abs(3 * pose_of(one)[:3, 3] - pose_of(other)[:3, 3]).max() < 1e-12
    points = scaled.points()
    assert all(np.abs(3 * position - points[key]).max() < 1e-12 for key, position in found.points().items())


def test_a_camera_that_sees_all_around_gives_points_and_no_pinhole(
    drive: World, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    found = imported(foreign_maps.stella(tmp_path / "hall.db", drive, model="Equirectangular"), tmp_path, capsys)
    for stand, body in zip(drive.stands, found.keyframes.values()):
        assert "camera" not in body and "features" not in body
        assert observes(body) == sorted(int(point) for at, point in enumerate(stand.seen) if at % 4)


@pytest.mark.parametrize("form", ["mcap", "db3", "folder"])
def test_map_data_stands_where_the_last_graph_has_it(form: str, drive: World, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    # Every graph before the last one was a metre off.
    path = foreign_messages.map_data(tmp_path / "office", drive, mcap=form == "mcap", moved=placed(turn("z", 0.2), [1.0, 0, 0]))
    if form == "db3":
        path = next(path.glob("*.db3"))
    # Messages have keypoints in an order of their own, which is not that of the words.
    assert_rtabmap(imported(path, tmp_path, capsys), drive, "office", last_first=True)


def test_a_node_that_left_the_graph_stands_where_it_came(drive: World, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from rosbags.rosbag2 import StoragePlugin, Writer

    messages, kind = foreign_messages.Messages(), foreign_messages.MAP_DATA
    with Writer(tmp_path / "b", version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connection = writer.add_connection("/mapData", kind, typestore=messages.store)
        for count in (1, 2):
            message = messages.map_data(drive, count)
            if count == 2:
                message.graph = messages.graph(drive.stands[1:2], [])
            writer.write(connection, count, messages.store.serialize_cdr(message, kind))
    found = imported(next((tmp_path / "b").glob("*.mcap")), tmp_path, capsys)
    assert "1 node is not in the last graph" in found.told
    first, second = found.keyframes.values()
    assert np.abs(pose_of(first) - drive.stands[0].map_from_camera).max() < FLOAT_M
    assert np.abs(pose_of(second) - drive.stands[1].map_from_camera).max() < FLOAT_M


@pytest.mark.parametrize("name", ["cdr_test_0.mcap", "talker.mcap"])
def test_a_real_recording_without_a_map_is_told_by_its_topics_and_counts(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    from rosbags.highlevel import AnyReader

    from revisit_slam.imports.rtabmap.definitions import typestore

    path = shared() / "samples/bags" / name
    told = refused(path, tmp_path, capsys)
    assert f"{name}: no rtabmap_msgs/msg/MapData in it" in told
    expected = counts(path.read_bytes())
    assert sum(expected.values()) > 0
    for (topic, kind), count in expected.items():
        assert f"{topic} ({kind}, {count})" in told
    # And read to the end, not only counted in the index.
    read: dict[tuple[str, str], int] = dict.fromkeys(expected, 0)
    with AnyReader([path], default_typestore=typestore()) as reader:
        for connection, _, data in reader.messages():
            reader.deserialize(data, connection.msgtype)
            read[connection.topic, connection.msgtype] += 1
    assert read == expected


@pytest.mark.parametrize("form", ["rtabmap", "stella", "stella_packed", "map_data"])
def test_replay_takes_the_recording_whole(form: str, drive: World, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = getattr(foreign_messages if form == "map_data" else foreign_maps, form)(tmp_path / "m", drive)
    found = imported(path, tmp_path, capsys, "--query")
    done = subprocess.run([find_binary(), "replay", found.path, "--json"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    figures = json.loads(done.stdout)
    assert (figures["keyframes"], figures["queries"], figures["closed_loops"]) == (len(drive.stands), len(drive.stands), 1)


@pytest.mark.parametrize("form", ["rtabmap", "stella"])
def test_geometry_of_the_server_finds_the_transform_between_the_ends(
    form: str, server: Server, client: Client, map_id: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """If any frame or order were wrong, the ends would not fit."""
    drive = world(points=4000, seed=11)
    found = imported(getattr(foreign_maps, form)(tmp_path / "m", drive), tmp_path, capsys)
    client.patch_map(map_id, {"settings": {"without_anchors": "geometry", "building_repeats": False}})
    names, points = list(found.keyframes), found.points()
    for id in (names[0], names[-1]):
        # As two robots: keyframes that share landmarks are covisible, and no candidates. Each has its points.
        body = {name: value for name, value in found.keyframes[id].items() if name != "covisible"}
        ids = [int(point) for point in features_of(body)[1] if point >= 0]
        positions = [points[body["session"], point].tolist() for point in ids]
        alone = {"session": id, "bow": {"words": [1, 2, 3], "weights": [1, 1, 1]}, "map_points": {"ids": ids, "positions": positions}}
        client.put_keyframe(map_id, id, {**body, **alone})
    answer = client.query_loop(map_id, {"keyframe": names[-1], "verify": "geometry"})
    candidate = next(one for one in answer.candidates if one.keyframe == names[0])
    assert candidate.geometry.status == "verified", candidate
    found_pose = candidate.geometry.candidate_from_query
    expected = np.linalg.inv(drive.stands[0].map_from_camera) @ drive.stands[-1].map_from_camera
    translation = [getattr(found_pose.translation, axis) for axis in "xyz"]
    assert np.abs(np.array(translation) - expected[:3, 3]).max() < 0.01


def test_a_long_name_of_a_file_is_cut_to_what_an_id_holds(drive: World, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    found = imported(foreign_maps.stella(tmp_path / f"{'x' * 150}.db", drive), tmp_path, capsys)
    (first, *_) = found.keyframes
    assert first.startswith("x" * 80) and first.endswith("-0") and len(first) == 100 + len("-0")


def test_words_of_two_rtabmap_databases_do_not_meet(drive: World, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    one = imported(foreign_maps.rtabmap(tmp_path / "a.db", drive), tmp_path, capsys)
    other = imported(foreign_maps.rtabmap(tmp_path / "b.db", drive), tmp_path, capsys)
    named = [{body["bow"]["vocabulary"] for body in found.keyframes.values()} for found in (one, other)]
    assert named == [{"rtabmap:a"}, {"rtabmap:b"}]
