"""revisit-play import of damaged files: one line that names the file and says what is wrong, whatever is broken."""

from __future__ import annotations

import random
import shutil
import sqlite3
import struct
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from imported import refused

msgpack = pytest.importorskip("msgpack")
pytest.importorskip("rosbags")
pycolmap = pytest.importorskip("pycolmap")

import foreign_maps  # noqa: E402
import foreign_messages  # noqa: E402
from foreign_world import world  # noqa: E402

from revisit_slam.play import main  # noqa: E402

DAMAGES = 40
FORMS = ("rtabmap", "stella", "stella_packed", "map_data", "colmap_bin", "colmap_txt")


def written(form: str, folder: Path) -> tuple[Path, list[Path]]:
    """Write a small map; return what is imported, and the files that may be damaged."""
    drive = world(stands=3, points=120)
    if form == "map_data":
        made = foreign_messages.map_data(folder / "bag", drive)
        return made, [made]
    if form.startswith("colmap"):
        pycolmap.set_random_seed(1)
        options = pycolmap.SyntheticDatasetOptions()
        options.num_frames_per_rig, options.num_points3D = 2, 20
        model = folder / "model"
        model.mkdir()
        made = pycolmap.synthesize_dataset(options)
        (made.write_binary if form == "colmap_bin" else made.write_text)(str(model))
        return model, [model / f"{name}.{form[-3:]}" for name in ("cameras", "images", "points3D")]
    made = getattr(foreign_maps, form)(folder / "map", drive)
    return made, [made]


def bitten(data: bytes, chance: random.Random) -> bytes:
    """Return data cut off, with bytes turned, or with a number that claims far too much."""
    kind, at = chance.randrange(4), chance.randrange(len(data))
    if kind == 0:
        return data[:at]
    if kind == 1:
        turned = bytearray(data)
        for _ in range(chance.randrange(1, 20)):
            turned[chance.randrange(len(data))] = chance.randrange(256)
        return bytes(turned)
    if kind == 2:
        return data[:at] + struct.pack("<Q", chance.choice([2**64 - 1, 2**40, 2**31])) + data[at + 8 :]
    return data[:at] + data[chance.randrange(len(data)) :]


@pytest.mark.parametrize("form", FORMS)
def test_a_damaged_file_is_read_or_refused_in_one_line(form: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    source, files = written(form, tmp_path)
    whole = {path: path.read_bytes() for path in files}
    chance, refusals = random.Random(form), 0
    for number in range(DAMAGES):
        path = chance.choice(files)
        path.write_bytes(bitten(whole[path], chance))
        status = main(["import", str(source), "-o", str(tmp_path / "o.ndjson")])
        told = capsys.readouterr().err
        assert status in (0, 1), (number, told)
        if status == 1:
            refusals += 1
            assert told.count("\n") == 1 and source.name in told and "Traceback" not in told, (number, told)
        path.write_bytes(whole[path])
    assert refusals > DAMAGES / 4
    assert main(["import", str(source), "-o", str(tmp_path / "o.ndjson")]) == 0


def sql(*statements: str) -> Callable[[Path], None]:
    """Return what runs statements in a database."""

    def damage(path: Path) -> None:
        with sqlite3.connect(path) as database:
            for statement in statements:
                database.execute(statement)

    return damage


@pytest.mark.parametrize(
    ("form", "damage", "told"),
    [
        ("rtabmap", sql("update Admin set version = 'x'"), "version in it is 'x'"),
        ("rtabmap", sql("update Admin set opt_poses = zeroblob(20)"), "the optimised poses"),
        ("rtabmap", sql("update Admin set opt_poses = opt_ids"), "not 12 floats each"),
        ("rtabmap", sql("update Data set calibration = x'00010203'"), "calibration of 4 bytes"),
        ("rtabmap", sql("update Data set calibration = substr(calibration, 1, 100)"), "calibration is cut off"),
        ("rtabmap", sql("update Feature set pos_x = 'left'"), "a feature's numbers are of another kind"),
        ("rtabmap", sql("update Feature set descriptor = x'0011223344556677', descriptor_size = 8 where rowid in (select min(rowid) from Feature group by node_id)"), "several lengths"),
        ("rtabmap", sql("drop table Feature"), "no table Feature"),
        ("rtabmap", sql("alter table Node drop column stamp"), "no column stamp in table Node"),
        ("rtabmap", sql("delete from Node"), "no keyframe in it"),
        ("stella", sql("update keyframes set n_keypts = 1000000000"), "claims 1000000000 keypoints"),
        ("stella", sql("update keyframes set n_keypts = n_keypts + 1"), "its keypoints are"),
        ("stella", sql("update keyframes set pose_cw = zeroblob(128)"), "its rotation is none"),
        ("stella", sql("update keyframes set pose_cw = 5"), "its pose is not of 16 numbers"),
        ("stella", sql("update keyframes set cam = 'rear'"), "of camera 'rear', which is not in the file"),
        ("stella", sql("update keyframes set ts = 1e300"), "its time"),
        ("stella", sql("update cameras set model_type = 'Mirror'"), "camera model 'Mirror' is not known"),
        ("stella", sql("update cameras set fx = null"), "are no numbers"),
        ("stella", sql("update associations set lm_ids = x'00'"), "its landmarks are 1 bytes"),
        ("stella", sql("drop table landmarks"), "no table landmarks"),
    ],
)
def test_what_is_wrong_with_a_database_is_told(
    form: str, damage: Callable[[Path], None], told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source, _ = written(form, tmp_path)
    damage(source)
    assert told in refused(source, tmp_path, capsys)


@pytest.mark.parametrize(
    ("where", "value", "told"),
    [
        (("keyframes",), 7, "a section is no map"),
        (("cameras", "front"), {}, "has no model and setup: camera front"),
    ],
)
def test_what_is_wrong_with_messagepack_is_told(
    where: tuple[str, ...], value: object, told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source, _ = written("stella_packed", tmp_path)
    whole = msgpack.unpackb(source.read_bytes())
    inside = whole
    for key in where[:-1]:
        inside = inside[key]
    inside[where[-1]] = value
    source.write_bytes(msgpack.packb(whole))
    assert told in refused(source, tmp_path, capsys)


def test_a_matrix_that_inflates_without_end_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    import zlib

    source, _ = written("rtabmap", tmp_path)
    bomb = zlib.compress(bytes(100 << 20))
    for rows, told in ((1, "does not decompress to its 400 bytes"), (2_000_000, "is larger than 64 MiB")):
        with sqlite3.connect(source) as database:
            database.execute("update Admin set opt_poses = ?", (bomb + struct.pack("<iii", rows, 100, 5),))
        assert told in refused(source, tmp_path, capsys)


def test_messages_that_contradict_themselves_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from rosbags.rosbag2 import StoragePlugin, Writer

    drive, messages, kind = world(stands=2, points=120), foreign_messages.Messages(), foreign_messages.MAP_DATA
    cases = {
        "its graph has 1 poses for 2 nodes": lambda m: setattr(m.graph, "poses_id", np.array([1, 2], np.int32)),
        "its words are not numbered": lambda m: setattr(m.nodes[0], "word_id_values", m.nodes[0].word_id_values * 0),
        "keypoints and": lambda m: setattr(m.nodes[0], "word_kpts", m.nodes[0].word_kpts[:-1]),
        "does not decompress": lambda m: setattr(m.nodes[0], "word_descriptors", m.nodes[0].word_descriptors * 0),
        "is no node's number": lambda m: setattr(m.nodes[0], "id", 0),
        "cameras, and places for 0": lambda m: setattr(m.nodes[0].data, "local_transform", []),
    }
    whole = messages.store.serialize_cdr(messages.map_data(drive, 1), kind)
    for number, (told, damage) in enumerate(cases.items()):
        folder = tmp_path / str(number)
        with Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
            connection = writer.add_connection("/mapData", kind, typestore=messages.store)
            message = messages.store.deserialize_cdr(whole, kind)
            damage(message)
            writer.write(connection, 1, messages.store.serialize_cdr(message, kind))
        assert told in refused(next(folder.glob("*.mcap")), tmp_path, capsys), told


def test_a_chunk_that_memory_would_not_hold_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    source, _ = written("map_data", tmp_path)
    whole = bytearray(source.read_bytes())
    at = 8
    while whole[at] != 6:  # The first chunk.
        at += 9 + struct.unpack_from("<Q", whole, at + 1)[0]
    struct.pack_into("<Q", whole, at + 9 + 16, 1 << 30)
    source.write_bytes(whole)
    assert "a chunk in it has 1024 MiB" in refused(source, tmp_path, capsys)


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("{tmp}/no.db",), "no.db: no such file"),
        (("{tmp}/text.db",), "text.db: not a COLMAP model's folder"),
        (("{tmp}/empty.db",), "empty.db: not a COLMAP model's folder"),
        (("{tmp}/other.db",), "a database of none of the systems: it has people"),
        (("{tmp}",), "no COLMAP model in it"),
        (("{tmp}/map", "--map", "a b"), "--map a b"),
        (("{tmp}/map", "--metres-per-unit", "-1"), "--metres-per-unit -1"),
        (("{tmp}/map", "--database", "{tmp}/map"), "--database: it belongs to a COLMAP model"),
        (("{tmp}/map", "--format", "stella"), "no table cameras"),
        (("{tmp}/map", "--format", "mcap"), "rosbags cannot read it, it is damaged"),
        (("{tmp}/map", "--session", ""), "--session"),
        (("{tmp}/map", "--session", "a b"), "--session a b: 1 to 100 letters"),
        (("{tmp}/map", "--set", "novalue"), "--set novalue"),
    ],
)
def test_what_cannot_be_meant_is_told(
    arguments: tuple[str, ...], told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    written("rtabmap", tmp_path)
    (tmp_path / "text.db").write_text("no map")
    (tmp_path / "empty.db").write_bytes(b"")
    with sqlite3.connect(tmp_path / "other.db") as database:
        database.execute("create table people (name text)")
    source, *more = (argument.format(tmp=tmp_path) for argument in arguments)
    assert told in refused(Path(source), tmp_path, capsys, *more)


def test_a_map_is_never_written_to(tmp_path: Path) -> None:
    source, _ = written("rtabmap", tmp_path)
    before = source.read_bytes()
    output = tmp_path / "out"
    output.mkdir()
    assert main(["import", str(source), "-o", str(output / "o.ndjson")]) == 0
    assert source.read_bytes() == before and {path.name for path in tmp_path.iterdir()} == {"map", "out"}
    assert main(["import", str(source), "-o", str(source)]) == 1 and source.read_bytes() == before
    shutil.rmtree(output)


def test_neither_imports_nor_hosts_need_opencv_or_a_reader(tmp_path: Path) -> None:
    sources = []
    for form in FORMS:
        (tmp_path / form).mkdir()
        sources.append(str(written(form, tmp_path / form)[0]))
    script = (
        "import sys; sys.modules.update(dict.fromkeys(('cv2', 'rapidocr', 'onnxruntime')))\n"
        "from revisit_slam.hosts import bridge, observations, ros_messages, rtabmap\n"
        "from revisit_slam.play import main\n"
        f"sys.exit(max(main(['import', source, '-o', {str(tmp_path / 'o.ndjson')!r}]) for source in {sources!r}))"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
