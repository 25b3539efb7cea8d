"""SQLite map of stella_vslam: `cameras`, `keyframes`, `landmarks`, `associations`."""

from __future__ import annotations

import sqlite3
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import RevisitError
from ..damage import Account
from ..limits import MAX_FEATURES, MAX_KEYFRAMES
from ..observation import NO_POINT, Features, Observation
from ..opened import Opened, Wanted
from ..point_store import PointStore
from ..poses import rigid
from ..sqlite_file import need_columns, reading
from .camera import Camera, camera_of, opened
from .keyframe import DESCRIPTOR_BYTES, MAX_KEYFRAME_ID, Keyframe, Names

TABLES = {
    "cameras": ("name", "setup_type", "model_type", "cols", "rows", "fx", "fy", "cx", "cy"),
    "keyframes": ("id", "ts", "cam", "pose_cw", "n_keypts", "undist_keypts", "descs"),
    "landmarks": ("id", "pos_w"),
    "associations": ("id", "lm_ids", "n_loop_edges", "loop_edges"),
}
# An OpenCV keypoint, as it lies in memory.
KEYPOINT = np.dtype(
    [("x", "<f4"), ("y", "<f4"), ("size", "<f4"), ("angle", "<f4"), ("response", "<f4"), ("octave", "<i4"), ("class", "<i4")]
)
POSITION = struct.Struct("<3d")
COLUMNS = "k.id, k.ts, k.cam, k.pose_cw, k.n_keypts, k.undist_keypts, k.descs, a.lm_ids, a.n_loop_edges, a.loop_edges"


def open_map(path: Path, wanted: Wanted) -> Opened:
    """Open a map."""
    need_columns(path, TABLES, "SQLite map of stella_vslam")
    account = Account(path)
    with reading(path) as connection:
        cameras = _cameras(connection, account)
    return opened(cameras, wanted, lambda: _keyframes(path, cameras, wanted, account), account)


def _cameras(connection: sqlite3.Connection, account: Account) -> dict[str, Camera]:
    found = {}
    for row in connection.execute(f"select {', '.join(TABLES['cameras'])} from cameras"):
        told = dict(zip(TABLES["cameras"], row))
        name = _text(told["name"])
        with account.part(f"camera {name}") as where:
            found[name] = camera_of(told | {kind: _text(told[kind]) for kind in ("model_type", "setup_type")}, where)
    return found


def _keyframes(path: Path, cameras: dict[str, Camera], wanted: Wanted, account: Account) -> Iterator[Observation]:
    scale = wanted.metres_per_unit or 1.0
    with reading(path) as connection, PointStore(account) as points:
        count = connection.execute("select count(*) from keyframes").fetchone()[0]
        if count > MAX_KEYFRAMES:
            raise RevisitError(f"{path}: it has {count} keyframes; at most {MAX_KEYFRAMES} are taken")
        for id, position in connection.execute("select id, pos_w from landmarks where id >= 0"):
            with account.left_out.unless(f"landmark {id}", "its position is not of three numbers"):
                points.add(id, *(scale * value for value in POSITION.unpack(position)))
        names = Names(wanted.name(path), cameras, points, scale)
        rows = connection.execute(f"select {COLUMNS} from keyframes k left join associations a on a.id = k.id order by k.id")
        for row in rows:
            with account.part(f"keyframe {row[0]}") as where:
                yield names.observation(_keyframe(row, where), where)


def _keyframe(row: tuple[Any, ...], where: str) -> Keyframe:
    id, stamp_s, camera, pose, count, keypoints, descriptors, landmarks, loops, loop_edges = row
    if not isinstance(id, int) or not 0 <= id <= MAX_KEYFRAME_ID or not isinstance(stamp_s, (int, float)):
        raise RevisitError(f"{where}: its number or its time is of another kind")
    if not isinstance(count, int) or not 0 <= count <= MAX_FEATURES:
        raise RevisitError(f"{where} claims {count} keypoints; at most {MAX_FEATURES} are taken")
    if not isinstance(pose, bytes) or len(pose) != 16 * 8:
        raise RevisitError(f"{where}: its pose is not of 16 numbers")
    points = np.frombuffer(_column(keypoints, count * KEYPOINT.itemsize, "keypoints", where), KEYPOINT)
    described = _column(descriptors, count * DESCRIPTOR_BYTES, "descriptors", where)
    # An association may be missing; then it observes nothing.
    landmarks = np.full(count, NO_POINT, "<i4").tobytes() if landmarks is None else landmarks
    loops = loops if isinstance(loops, int) and 0 <= loops <= MAX_KEYFRAMES else 0
    edges = _column(loop_edges, 4 * loops, "loop edges", where) if loops else b""
    return Keyframe(
        id, float(stamp_s), _text(camera),
        # Eigen keeps a matrix column by column.
        rigid(np.frombuffer(pose, "<f8").reshape(4, 4).T, where),
        Features(
            np.stack((points["x"], points["y"]), axis=1), points["octave"], points["angle"],
            np.frombuffer(described, np.uint8).reshape(count, DESCRIPTOR_BYTES),
            np.frombuffer(_column(landmarks, 4 * count, "landmarks", where), "<i4").astype(np.int64),
        ),
        [int(edge) for edge in np.frombuffer(edges, "<i4")],
    )  # fmt: skip


def _column(value: Any, size: int, what: str, where: str) -> bytes:
    value = b"" if value is None else value
    if not isinstance(value, bytes) or len(value) != size:
        told = f"{len(value)} bytes" if isinstance(value, bytes) else "no blob"
        raise RevisitError(f"{where}: its {what} are {told}, not {size} bytes")
    return value


def _text(value: Any) -> str:
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)
