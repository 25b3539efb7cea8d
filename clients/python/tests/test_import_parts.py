"""revisit-play import where a part of a map is wrong: it is left out, counted and told, and the recording stays whole."""

from __future__ import annotations

import json
import math
import shutil
import sqlite3
import struct
import subprocess
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from imported import Imported, features_of, imported, observes, refused, shared

msgpack = pytest.importorskip("msgpack")
pytest.importorskip("rosbags")
pycolmap = pytest.importorskip("pycolmap")

import foreign_maps  # noqa: E402
import foreign_messages  # noqa: E402
from foreign_world import World, world  # noqa: E402

from revisit_slam.errors import RevisitError  # noqa: E402
from revisit_slam.imports.opened import Wanted  # noqa: E402
from revisit_slam.imports.rtabmap.database import open_map  # noqa: E402
from revisit_slam.play import main  # noqa: E402
from revisit_slam.server import find_binary  # noqa: E402

NAN = float("nan")
Damage = Callable[[Path], None]


@pytest.fixture(scope="module")
def drive() -> World:
    return world(stands=5, points=300)


def sql(statement: str, *values: object) -> Damage:
    """Return what runs a statement in a database."""

    def damage(path: Path) -> None:
        # A connection that is not closed keeps its log until it is collected.
        with closing(sqlite3.connect(path)) as database, database:
            assert database.execute(statement, values).rowcount > 0

    return damage


def optimised(id: int, number: float) -> Damage:
    """Return what puts a number into the optimised pose of a node of RTAB-Map."""

    def damage(path: Path) -> None:
        import zlib

        with sqlite3.connect(path) as database:
            blob = database.execute("select opt_poses from Admin").fetchone()[0]
            rows = np.frombuffer(zlib.decompress(blob[:-12]), "<f4").copy().reshape(-1, 12)
            rows[id - 1, 3] = number
            database.execute("update Admin set opt_poses = ?", (zlib.compress(rows.tobytes()) + blob[-12:],))

    return damage


def entry(*keys: str, value: object) -> Damage:
    """Return what puts a value into a map of MessagePack."""

    def damage(path: Path) -> None:
        whole = inside = msgpack.unpackb(path.read_bytes())
        for key in keys[:-1]:
            inside = inside[key]
        inside[keys[-1]] = value
        path.write_bytes(msgpack.packb(whole))

    return damage


def message(change: Callable[[Any], None], number: int) -> Damage:
    """Return what changes one message of a recording of MapData."""

    def damage(path: Path) -> None:
        from rosbags.highlevel import AnyReader
        from rosbags.rosbag2 import StoragePlugin, Writer

        store = foreign_messages.Messages().store
        with AnyReader([path], default_typestore=store) as reader:
            taken = [(stamp, data) for _, stamp, data in reader.messages()]
        path.unlink()
        with Writer(path.parent / "again", version=9, storage_plugin=StoragePlugin.MCAP) as writer:
            connection = writer.add_connection("/rtabmap/mapData", foreign_messages.MAP_DATA, typestore=store)
            for at, (stamp, data) in enumerate(taken, 1):
                read = store.deserialize_cdr(data, foreign_messages.MAP_DATA)
                if at == number:
                    change(read)
                writer.write(connection, stamp, store.serialize_cdr(read, foreign_messages.MAP_DATA))
        (path.parent / "again" / "again.mcap").rename(path)
        shutil.rmtree(path.parent / "again")

    return damage


def last_pose_of(node: int) -> Damage:
    """Return what breaks the pose of a node in every graph, and its own."""

    def change(read: Any) -> None:
        read.graph.poses[node - 1].position.x = NAN
        for one in read.nodes:
            one.pose.position.x = NAN if one.id == node else one.pose.position.x

    def damage(path: Path) -> None:
        for number in range(node, 6):
            message(change, number)(path)

    return damage


# A map's form, what is done to it, the places of the keyframes that are left out, and what is told.
PARTS = [
    ("rtabmap", sql("update Data set calibration = x'00010203' where id = 2"), [1], "left out 1: its calibration of 4 bytes"),
    ("rtabmap", sql("update Data set calibration = substr(calibration, 1, 99) where id = 1"), [0], "is cut off, or of no form"),
    ("rtabmap", sql("update Feature set pos_x = 'left' where node_id = 5"), [4], "numbers are of another kind: node 5"),
    ("rtabmap", sql("update Feature set word_id = 'x' where node_id in (1, 3)"), [0, 2], "another kind: node 1, node 3"),
    ("rtabmap", sql("update Node set id = -5 where id = 1"), [0], "of map 0 has no number that a node has: node -5"),
    ("rtabmap", sql("update Node set map_id = case id when 100 then 'x' else x'00' end where id > 99"), [], "of map x has no number"),
    ("rtabmap", optimised(2, NAN), [1], "left out 1: its position (nan,"),
    ("rtabmap", optimised(2, 1e30), [1], "is no place: node 2"),
    ("stella", sql("update keyframes set pose_cw = zeroblob(128) where id = 0"), [0], "1: its rotation is none: keyframe 0"),
    ("stella", sql("update keyframes set pose_cw = ? where id = 5", np.full(16, NAN).tobytes()), [1], "its rotation is none"),
    ("stella", sql("update keyframes set cam = 'rear' where id = 20"), [4], "'rear', which is not in the file: keyframe 20"),
    ("stella", sql("update keyframes set descs = x'00' where id = 5"), [1], "its descriptors are 1 bytes, not"),
    ("stella", sql("update keyframes set ts = 'noon' where id = 5"), [1], "its number or its time is of another kind"),
    ("stella", sql("update keyframes set ts = 1e300 where id = 5"), [1], "its time 1e+300 s is none: keyframe 5"),
    ("stella", sql("update associations set lm_ids = x'00' where id = 0"), [0], "its landmarks are 1 bytes"),
    ("stella_packed", entry("keyframes", "0", "rot_cw", value=[0, 0, 0, 0]), [0], "its rotation is no quaternion: keyframe 0"),
    ("stella_packed", entry("keyframes", "0", "rot_cw", value=[0, 0, 1]), [0], "its rotation is not of 4 numbers"),
    ("stella_packed", entry("keyframes", "5", "trans_cw", value=[0, "far", 0]), [1], "its translation is not of 3 numbers"),
    ("stella_packed", entry("keyframes", "5", "trans_cw", value=[0, NAN, 0]), [1], "is no place: keyframe 5"),
    ("stella_packed", entry("keyframes", "0", "descs", value=[[1, 2]]), [0], "are of another form"),
    ("stella_packed", entry("keyframes", "0", "lm_ids", value=[1]), [0], "keypoints"),
    ("stella_packed", entry("keyframes", "20", value=7), [4], "has no ts: keyframe 20"),
    ("stella_packed", entry("keyframes", "five", value={}), [], "its number is none: keyframe five"),
    ("map_data", message(lambda m: setattr(m.nodes[0], "word_kpts", m.nodes[0].word_kpts[:1]), 1), [0], " 1 keypoints and "),
    ("map_data", message(lambda m: setattr(m.nodes[0].data, "local_transform", []), 5), [4], "and places for 0: node 5"),
    ("map_data", message(lambda m: setattr(m.nodes[0], "stamp", NAN), 3), [], ""),
    ("map_data", last_pose_of(2), [1], "is no place: node 2"),
]


@pytest.mark.parametrize(
    ("form", "damage"),
    [
        ("rtabmap", sql("update Data set calibration = x'00' where id = 3")),
        ("map_data", message(lambda m: setattr(m.nodes[0].data, "local_transform", []), 3)),
    ],
)
def test_neighbours_of_a_node_that_is_left_out_are_covisible(
    form: str, damage: Damage, drive: World, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source = getattr(foreign_messages if form == "map_data" else foreign_maps, form)(tmp_path / "m", drive)
    damage(source)
    found = imported(source, tmp_path, capsys, "--session", "m")
    near = {id: [other["keyframe"] for other in body["covisible"]] for id, body in found.keyframes.items()}
    assert near == {"m-0-1": [], "m-0-2": ["m-0-1"], "m-0-4": ["m-0-2"], "m-0-5": ["m-0-4"]}


def points_seen(found: Imported) -> set[tuple[str, int]]:
    """Return the points that the features of a recording name."""
    return {(body["session"], int(id)) for body in found.keyframes.values() for id in features_of(body)[1] if id >= 0}


@pytest.mark.parametrize(("form", "damage", "places", "told"), PARTS)
def test_a_keyframe_that_is_wrong_is_left_out_and_the_others_are_whole(
    form: str, damage: Damage, places: list[int], told: str, drive: World, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source = getattr(foreign_messages if form == "map_data" else foreign_maps, form)(tmp_path / "m", drive)
    whole = imported(source, tmp_path, capsys, name="whole.ndjson")
    damage(source)
    found = imported(source, tmp_path, capsys, "--session", source.stem)
    assert told in found.told
    names = list(whole.keyframes)
    left_out = {names[place] for place in places}
    assert list(found.keyframes) == [name for name in names if name not in left_out]
    assert found.loops == [loop for loop in whole.loops if left_out.isdisjoint(loop)]
    # What a keyframe that is left out would have placed, the next one that sees it places.
    before, after = whole.points(), found.points()
    assert after.keys() >= points_seen(found) & before.keys()
    assert all(np.abs(position - before[key]).max() < 1e-9 for key, position in after.items())


@pytest.mark.parametrize(
    ("form", "damage", "told"),
    [
        ("stella", sql("update landmarks set pos_w = zeroblob(23) where id = 5"), "not of three numbers: landmark 5"),
        ("stella", sql("update landmarks set pos_w = ? where id = 5", np.full(3, NAN).tobytes()), "its position is no place: point 5"),
        ("stella_packed", entry("landmarks", "5", "pos_w", value=[1, 2, NAN]), "its position is no place: point 5"),
        ("stella_packed", entry("landmarks", "5", value=[]), "its position is not of 3 numbers: landmark 5"),
    ],
)
def test_a_point_that_is_wrong_is_left_out_alone(
    form: str, damage: Damage, told: str, drive: World, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source = getattr(foreign_maps, form)(tmp_path / "m", drive)
    whole = imported(source, tmp_path, capsys, name="whole.ndjson")
    assert ("m", 5) in whole.points()
    damage(source)
    found = imported(source, tmp_path, capsys)
    assert told in found.told and found.told.count("left out 1: ") == 1
    assert found.keyframes.keys() == whole.keyframes.keys() and whole.points().keys() - found.points().keys() == {("m", 5)}


def test_a_camera_that_is_wrong_leaves_its_keyframes_out(
    drive: World, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source = foreign_maps.stella(tmp_path / "hall.db", drive)
    sql("insert into cameras (id, name, setup_type, model_type) values (1, 'rear', 'Stereo', 'Mirror')")(source)
    sql("update keyframes set cam = 'rear' where id > 5")(source)
    found = imported(source, tmp_path, capsys)
    assert list(found.keyframes) == ["hall-0", "hall-5"]
    assert "left out 1: camera model 'Mirror' is not known" in found.told and "camera rear" in found.told
    assert "left out 3: is of camera 'rear', which is not in the file: keyframe 10, keyframe 15, keyframe 20" in found.told


def test_what_is_left_out_is_counted_for_a_program_and_of_many_reasons_the_first_are_told(
    drive: World, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source = foreign_maps.stella(tmp_path / "hall.db", world(stands=30, points=300))
    sql("update keyframes set n_keypts = 30000 + id where id > 0")(source)
    assert main(["import", str(source), "-o", str(tmp_path / "o.ndjson"), "--json"]) == 0
    out, told = capsys.readouterr()
    assert (json.loads(out)["keyframes"], json.loads(out)["left_out"]) == (1, 29)
    assert told.count("left out 1: claims") == 10 and "and left out for 19 other reasons" in told


def test_replay_takes_what_is_left(drive: World, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    source = foreign_maps.rtabmap(tmp_path / "m.db", drive)
    sql("update Data set calibration = x'00' where id in (1, 3)")(source)
    found = imported(source, tmp_path, capsys)
    done = subprocess.run([find_binary(), "replay", found.path, "--json"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["keyframes"] == len(drive.stands) - 2


def test_a_file_that_breaks_off_in_the_middle_is_no_map(drive: World, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    source = foreign_maps.stella(tmp_path / "hall.db", world(stands=40, points=2000))
    data = source.read_bytes()
    source.write_bytes(data[: len(data) // 2 // 4096 * 4096] + bytes(4096) * 20)
    told = refused(source, tmp_path, capsys)
    assert "hall.db: SQLite cannot read it" in told
    assert f"`sqlite3 {source} .recover | sqlite3 OUT.db` saves what is in it" in told


class Model:
    """A small model of COLMAP, as text, to be changed."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        folder.mkdir()
        self.cameras = {1: "PINHOLE 640 480 500 500 320 240"}
        self.images = [(f"{number}.png", 1, "1 0 0 0 0 0 0", [7, 8, 9 + number]) for number in range(3)]
        self.points = {id: (0.1 * at, 0.0, 5.0 + at) for at, id in enumerate((7, 8, 9, 10, 11))}

    def write(self, *, end: str = "\n", blank: str = " ", mark: bytes = b"") -> Path:
        """Write it."""
        lines = {
            "cameras": [f"{id}{blank}{told.replace(' ', blank)}" for id, told in self.cameras.items()],
            "images": [
                line
                for number, (name, camera, pose, ids) in enumerate(self.images, 1)
                for line in (
                    blank.join((str(number), *pose.split(" "), str(camera), name)),
                    blank.join(f"{10 + at}.5{blank}{20 + at}.5{blank}{id}" for at, id in enumerate(ids)),
                )
            ],
            "points3D": [blank.join((str(id), *map(str, place), "1 2 3 0.5")) for id, place in self.points.items()],
        }
        for name, written in lines.items():
            text = "".join(f"{line}{end}" for line in (f"# {name}", *written))
            (self.folder / f"{name}.txt").write_bytes(mark + text.encode("utf-8", "surrogateescape"))
        return self.folder

    def write_binary(self) -> Path:
        """Write the same as COLMAP's binary form, number by number: foreign programs write what pycolmap does not."""
        data = {"cameras": struct.pack("<Q", len(self.cameras))}
        for id, told in self.cameras.items():
            _, width, height, *params = told.split()
            data["cameras"] += struct.pack("<iiQQ4d", id, 1, int(width), int(height), *map(float, params))
        data["images"] = struct.pack("<Q", len(self.images))
        for number, (name, camera, pose, ids) in enumerate(self.images, 1):
            data["images"] += struct.pack("<I7dI", number, *map(float, pose.split()), camera)
            data["images"] += name.encode("utf-8", "surrogateescape") + b"\0" + struct.pack("<Q", len(ids))
            data["images"] += b"".join(struct.pack("<ddQ", 10.5 + at, 20.5 + at, id % 2**64) for at, id in enumerate(ids))
        data["points3D"] = struct.pack("<Q", len(self.points))
        for id, place in self.points.items():
            data["points3D"] += struct.pack("<Q3d3BdQ", id % 2**64, *place, 1, 2, 3, 0.5, 0)
        for name, written in data.items():
            (self.folder / f"{name}.bin").write_bytes(written)
        return self.folder


def test_a_text_model_is_read_as_editors_and_other_systems_leave_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    model = Model(tmp_path / "m")
    model.images = [(name, *rest) for name, (_, *rest) in zip(("hall 1/a  b (2).png", "hall 2/c.png", "d.png"), model.images)]
    expected = imported(model.write(), tmp_path, capsys, name="expected.ndjson")
    assert list(expected.keyframes) == ["d", "hall:20:1.a:20::20:b:20::28:2:29:", "hall:20:2.c"]
    mark = b"\xef\xbb\xbf"
    for ways in ({"end": "\r\n"}, {"blank": "\t"}, {"mark": mark}, {"end": "\r\n", "blank": "\t", "mark": mark}):
        assert imported(model.write(**ways), tmp_path, capsys).keyframes == expected.keyframes, ways
    for name in ("images", "cameras"):
        model.write()
        path = model.folder / f"{name}.txt"
        path.write_bytes(path.read_text().encode("utf-16"))
        assert f"{name}.txt: a text in UTF-16: save it as UTF-8" in refused(model.folder, tmp_path, capsys)


@pytest.mark.parametrize("form", ["txt", "bin"])
def test_names_in_another_encoding_are_names(form: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    model = Model(tmp_path / "m")
    names = [name.decode("utf-8", "surrogateescape") for name in (b"caf\xe9.png", b"caf\xe8.png", b"\xe5\x85\xa5.png")]
    model.images = [(name, *rest) for name, (_, *rest) in zip(names, model.images)]
    model.images[0] = (names[0], 4, *model.images[0][2:])
    found = imported(model.write() if form == "txt" else model.write_binary(), tmp_path, capsys)
    assert len(found.keyframes) == 2 and "image caf?.png" in found.told


@pytest.mark.parametrize("form", ["txt", "bin"])
@pytest.mark.parametrize(
    ("change", "places", "told"),
    [
        (lambda m: m.images.__setitem__(1, ("1.png", 1, "nan 0 0 0 0 0 0", [7, 8])), [0, 2], "is no quaternion: image 1.png"),
        (lambda m: m.images.__setitem__(0, ("0.png", 1, "1 0 0 0 0 inf 0", [7, 8])), [1, 2], "is no place: image 0.png"),
        (lambda m: m.images.__setitem__(0, ("0.png", 3, "1 0 0 0 0 0 0", [7])), [1, 2], "which the model does not have: image 0"),
        (lambda m: m.images.__setitem__(0, ("0.png", 1, "1 0 0 0 0 0 0", [99])), [1, 2], "point 99, which is not there: image 0"),
        (lambda m: m.images.append(("2.png", 1, "1 0 0 0 5 0 0", [7])), [0, 1, 2], "is in it twice: image 2.png"),
        (lambda m: m.points.__setitem__(8, (NAN, 0.0, 1.0)), [0, 1, 2], "its position is no place: point 8"),
        (lambda m: m.cameras.__setitem__(2, "PINHOLE 640 480 nan nan 1 1"), [0, 1, 2], "focal lengths nan, nan: camera 2"),
    ],
)
def test_what_is_wrong_in_a_model_is_left_out(
    form: str, change: Callable[[Model], None], places: list[int], told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    model = Model(tmp_path / "m")
    change(model)
    found = imported(model.write() if form == "txt" else model.write_binary(), tmp_path, capsys)
    assert told in found.told and found.told.count("left out 1: ") == 1
    assert list(found.keyframes) == [str(place) for place in places]
    placed = {id for _, id in found.points()}
    assert placed == {id for body in found.keyframes.values() for id in observes(body)} == placed & model.points.keys()
    assert 8 in placed or math.isnan(model.points[8][0])


def test_numbers_of_windows_and_an_unknown_camera_are_left_out(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    model = Model(tmp_path / "m")
    model.images[0] = ("0.png", 1, "-nan(ind) 0 0 0 0 0 0", [7])
    model.images[1] = ("1.png", 2, "1 0 0 0 0 0 0", [7])
    model.cameras[2] = "PINHOOLE 640 480 1"
    model.points[9] = ("1.#QNAN", 0, 0)
    found = imported(model.write(), tmp_path, capsys)
    assert list(found.keyframes) == ["2"] and "camera model PINHOOLE is not known" in found.told
    (model.folder / "images.txt").write_text("1 1 0 0 0 0 0 0 1 a.png\n1 2 lamp\n2 1 0 0 0 0 0 0 1 b.png\n1 2 7\n")
    assert "X Y POINT3D_ID ..: image a.png" in imported(model.folder, tmp_path, capsys).told
    (model.folder / "images.txt").write_text("one 1 0 0 0 0 0 0 1 a.png\n1 2 7\n")
    assert "images.txt: line 1 is no IMAGE_ID" in refused(model.folder, tmp_path, capsys)


HASHES = [2**63, 2**64 - 2, 3 * 2**61 + 12345, 5, 2**62 + 1]


NEGATIVE = [-7, -8, -2, -(2**63), 3]


@pytest.mark.parametrize(("form", "ids"), [("txt", HASHES), ("bin", HASHES), ("txt", NEGATIVE)])
def test_ids_of_points_that_the_server_does_not_take_are_numbered(
    form: str, ids: list[int], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    model = Model(tmp_path / "m")
    model.points = {id: place for id, place in zip(ids, model.points.values())}
    none = -1 if form == "txt" else 2**64 - 1
    model.images = [(*image[:3], [*ids[at : at + 3], none]) for at, image in enumerate(model.images)]
    source = model.write() if form == "txt" else model.write_binary()
    found = imported(source, tmp_path, capsys)
    assert "points are numbered in the order of the file" in found.told
    assert [sorted(observes(body)) for body in found.keyframes.values()] == [[at, at + 1, at + 2] for at in range(3)]
    places = list(model.points.values())
    assert {id: tuple(position) for (_, id), position in found.points().items()} == dict(enumerate(places))
    assert imported(source, tmp_path, capsys, name="again.ndjson").lines == found.lines
    done = subprocess.run([find_binary(), "replay", found.path, "--json"], capture_output=True, text=True)
    assert done.returncode == 0 and json.loads(done.stdout)["keyframes"] == 3, done.stderr


def test_a_model_with_rigs_and_frames_is_what_pycolmap_reads(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from test_import_colmap import assert_equal

    pycolmap.set_random_seed(5)
    options = pycolmap.SyntheticDatasetOptions()
    options.num_rigs, options.num_cameras_per_rig, options.num_frames_per_rig, options.num_points3D = 2, 2, 3, 40
    made = pycolmap.synthesize_dataset(options)
    for form in ("bin", "txt"):
        folder = tmp_path / form
        folder.mkdir()
        (made.write_binary if form == "bin" else made.write_text)(str(folder))
        assert (folder / f"rigs.{form}").is_file() and (folder / f"frames.{form}").is_file()
        assert_equal(imported(folder, tmp_path, capsys), pycolmap.Reconstruction(str(folder)))


def test_a_database_of_colmap_leaves_out_what_is_wrong_in_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "c.db"
    with sqlite3.connect(path) as database:
        database.executescript(
            """create table cameras (camera_id integer primary key, model integer, width integer, height integer, params blob);
            create table images (image_id integer primary key, name text, camera_id integer);
            create table two_view_geometries (pair_id integer primary key, rows integer, cols integer, data blob);"""
        )
        for id, model in ((1, 0), (2, 99), (3, 0)):
            params = np.array([500.0, 320.0, 240.0]).tobytes()[: 24 if id != 3 else 23]
            database.execute("insert into cameras values (?, ?, 640, 480, ?)", (id, model, params))
        for id, camera in ((1, 1), (2, 1), (3, 2), (4, 3), (5, 7)):
            name = f"caf\xe9 {id}.png".encode("latin-1")
            database.execute("insert into images values (?, cast(? as text), ?)", (id, name, camera))
        for one, other in ((1, 2), (1, 3), (2, 9)):
            database.execute("insert into two_view_geometries values (?, 20, 2, null)", (one * (2**31 - 1) + other,))
    found = imported(path, tmp_path, capsys)
    first, second = found.keyframes
    assert found.keyframes[second]["covisible"] == [{"keyframe": first, "shared": 20}]
    for told in ("camera model 99 is not known", "of another kind: camera 3", "of image 9, which is", "of camera 7, which"):
        assert told in found.told, found.told


# What is imported, what of it is written, and what is told.
OTHERS: list[tuple[str, Callable[[Path], object], str]] = [
    ("map.msg.zst", lambda p: p.write_bytes(b"\x28\xb5\x2f\xfd" + bytes(99)), "compressed with zstd: unpack it (`zstd -d`)"),
    ("bag_0.mcap.zstd", lambda p: p.write_bytes(b"\x28\xb5\x2f\xfd" + bytes(99)), "compressed with zstd: unpack it (`zstd -d`)"),
    ("map.db.gz", lambda p: p.write_bytes(b"\x1f\x8b" + bytes(99)), "compressed with gzip"),
    ("maps.zip", lambda p: p.write_bytes(b"PK\x03\x04" + bytes(99)), "a zip archive"),
    ("map.db", lambda p: p.write_bytes(b"version https://git-lfs.github.com/spec/v1\n"), "a pointer of Git LFS: `git lfs pull`"),
    ("map.db", lambda p: p.write_bytes(b""), "it looks like this: empty"),
    ("map.db", lambda p: p.write_text("a map\n"), "it looks like this: a text"),
    ("images.txt", lambda p: p.write_text("1 1 0 0 0 0 0 0 1 a.png\n"), "of a COLMAP model its folder is imported: {folder}"),
    ("old.bag", lambda p: p.write_bytes(b"#ROSBAG V2.0\n" + bytes(99)), "a ROS 1 bag"),
    ("old.bag.active", lambda p: p.write_bytes(b"#ROSBAG V2.0\n" + bytes(99)), "`rosbag reindex {path}` saves what is in it"),
    ("bag", lambda p: (p.mkdir(), (p / "b_0.db3").write_bytes(b"x")), "`ros2 bag reindex {path}` writes the metadata.yaml"),
    ("bag", lambda p: (p.mkdir(), (p / "b_0.mcap").write_bytes(b"x")), "`ros2 bag reindex {path}` writes the metadata.yaml"),
    ("bag", lambda p: (p.mkdir(), (p / "metadata.yaml").write_bytes(b"")), "`ros2 bag reindex {path}` writes the metadata.yaml"),
]


@pytest.mark.parametrize(("name", "write", "told"), OTHERS)
def test_a_file_of_another_kind_says_what_it_looks_like_and_what_to_do(
    name: str, write: Callable[[Path], object], told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / name
    write(path)
    assert told.format(path=path, folder=tmp_path) in refused(path, tmp_path, capsys)


@pytest.mark.parametrize("cut", [5, 300, 0.5])
def test_a_recording_whose_recorder_was_killed_says_how_it_is_saved(
    cut: float, drive: World, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = foreign_messages.map_data(tmp_path / "bag", drive)
    data = path.read_bytes()
    path.write_bytes(data[: int(len(data) * cut) if cut < 1 else -int(cut)])
    assert f"`mcap recover {path} -o OUT.mcap` saves what is in it" in refused(path, tmp_path, capsys)
    assert "`ros2 bag reindex" in refused(path.parent, tmp_path, capsys)


def test_a_database_that_is_being_written_says_so(drive: World, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = foreign_maps.rtabmap(tmp_path / "m.db", drive)
    writer = sqlite3.connect(path, isolation_level=None)
    writer.execute("begin exclusive")
    assert "m.db: another program writes to it: end that, or import a copy" in refused(path, tmp_path, capsys)
    writer.execute("pragma cache_size = 1")
    for _ in range(200):
        writer.execute("insert into Word values (null, 4000, zeroblob(4000), null)")
    copy = tmp_path / "copy"
    copy.mkdir()
    for name in ("m.db", "m.db-journal"):
        shutil.copy(tmp_path / name, copy / name)
    writer.close()
    told = refused(copy / "m.db", tmp_path, capsys)
    assert "writing did not end, says m.db-journal" in told and f"`sqlite3 {copy / 'm.db'} .tables`" in told


def test_another_program_can_write_while_a_database_is_read_and_then_the_import_is_refused(drive: World, tmp_path: Path) -> None:
    path = foreign_maps.rtabmap(tmp_path / "m.db", drive)
    keyframes = open_map(path, Wanted()).keyframes()
    next(keyframes)
    # At a lock RTAB-Map would end.
    writer = sqlite3.connect(path, timeout=0, isolation_level=None)
    for statement in ("begin exclusive", "insert into Word values (null, 8, zeroblob(8), null)", "commit"):
        writer.execute(statement)
    writer.close()
    with pytest.raises(RevisitError) as error:
        list(keyframes)
    assert str(error.value) == f"{path}: another program writes to it: end that, or import a copy"


def test_a_database_is_read_again_when_nobody_writes_any_more(drive: World, tmp_path: Path) -> None:
    path = foreign_maps.rtabmap(tmp_path / "m.db", drive)
    sql("insert into Word values (null, 8, zeroblob(8), null)")(path)
    before = path.stat().st_mtime_ns, path.read_bytes()
    assert len(list(open_map(path, Wanted()).keyframes())) == len(drive.stands)
    assert (path.stat().st_mtime_ns, path.read_bytes()) == before and list(tmp_path.iterdir()) == [path]


def test_a_bag_whose_last_messages_are_in_the_log_says_so(
    drive: World, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = foreign_messages.map_data(tmp_path / "bag", drive, mcap=False)
    (part,) = folder.glob("*.db3")
    assert len(imported(folder, tmp_path, capsys).keyframes) == len(drive.stands)
    part.with_name(f"{part.name}-wal").write_bytes(b"")
    assert len(imported(folder, tmp_path, capsys).keyframes) == len(drive.stands)
    part.with_name(f"{part.name}-wal").write_bytes(bytes(100))
    for source in (folder, part):
        assert f"says {part.name}-wal" in refused(source, tmp_path, capsys)


def test_a_database_with_a_log_is_read_and_nothing_is_left_beside_it(
    drive: World, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = foreign_maps.rtabmap(tmp_path / "m.db", drive)
    expected = imported(path, tmp_path, capsys, name="expected.ndjson").lines
    writer = sqlite3.connect(path)
    assert writer.execute("pragma journal_mode = wal").fetchone() == ("wal",)
    sql("update Data set calibration = x'00' where id = 1")(path)
    # The change is only in the log so far.
    assert "left out 1: its calibration" in imported(path, tmp_path, capsys).told
    sql("update Data set calibration = ? where id = 1", foreign_maps.mono_calibration())(path)
    writer.close()
    assert imported(path, tmp_path, capsys, "--session", "m").lines == expected
    assert {file.name for file in tmp_path.iterdir()} == {"m.db", "expected.ndjson", "o.ndjson.zst"}


def test_a_real_model_with_one_image_damaged_keeps_the_others(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = shutil.copytree(shared() / "samples/colmap/reconstruction", tmp_path / "real")
    whole = imported(folder, tmp_path, capsys, name="whole.ndjson")
    lines = (folder / "images.txt").read_text().splitlines(keepends=True)
    at = next(at for at, line in enumerate(lines) if not line.startswith("#"))
    id, _, *rest = lines[at].split(" ")
    (folder / "images.txt").chmod(0o644)
    (folder / "images.txt").write_text("".join([*lines[:at], " ".join((id, "-nan(ind)", *rest)), *lines[at + 1 :]]))
    found = imported(folder, tmp_path, capsys)
    assert len(found.keyframes) == len(whole.keyframes) - 1 and "left out 1: its rotation is no quaternion" in found.told
    assert found.points().keys() == {("real", id) for body in found.keyframes.values() for id in observes(body)}


def test_a_live_map_with_one_pose_that_is_none_sends_the_other_nodes(drive: World, caplog: pytest.LogCaptureFixture) -> None:
    from revisit_slam.hosts.rtabmap import RtabmapBridge

    sent: list[str] = []

    class Bridge:
        def leave(self, work: Callable[[], None]) -> None:
            work()

        def send(self, id: str, body: dict[str, Any]) -> bool:
            sent.append(id)
            return True

        def is_stored(self, id: str) -> bool:
            return False

    bridge, messages = RtabmapBridge(Bridge(), "robot"), foreign_messages.Messages()  # type: ignore[arg-type]
    for number in range(1, len(drive.stands) + 1):
        read = messages.map_data(drive, number)
        if number > 1:
            read.graph.poses[1].orientation.w = NAN
        if number == 3:
            read.nodes[0].word_id_values = read.nodes[0].word_id_values * 0
            read.nodes.append(messages.map_data(drive, number + 1).nodes[0])
        bridge.on_map_data(read)
    # Node 2 stands where its odometry has it, and node 4 came with node 3.
    assert sent == ["robot-0-1", "robot-0-2", "robot-0-4", "robot-0-5"]
    assert "its rotation is no quaternion: the graph's pose of node 2" in caplog.text and "not numbered: node 3" in caplog.text
