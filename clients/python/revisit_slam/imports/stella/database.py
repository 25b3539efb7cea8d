"""SQLite map of stella_vslam: `cameras`, `keyframes`, `landmarks`, `associations`."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import RevisitError
from ..damage import Account
from ..limits import MAX_FEATURES, MAX_KEYFRAMES
from ..observation import NO_POINT, Observation
from ..opened import Opened, Wanted
from ..point_ids import PointIds
from ..poses import checked, rigid
from ..sqlite_file import need_columns, reading, tables
from .camera import Camera, camera_of, opened
from .keyframe import DESCRIPTOR_BYTES, MAX_KEYFRAME_ID, Keyframe, Names, landmarks_of

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
COLUMNS = "k.id, k.ts, k.cam, k.pose_cw, k.n_keypts, k.undist_keypts, k.descs, a.lm_ids, a.n_loop_edges, a.loop_edges"
IDS_AT_ONCE = 500


def open_map(path: Path, wanted: Wanted) -> Opened:
    """Open a map."""
    need_columns(path, tables(path), TABLES, "SQLite map of stella_vslam")
    account = Account(path)
    with reading(path) as connection:
        cameras = _cameras(connection, account)

    def keyframes() -> Iterator[Observation]:
        with reading(path) as connection:
            yield from _keyframes(path, connection, cameras, wanted, account)

    return opened(cameras, wanted, keyframes, account)


def _cameras(connection: sqlite3.Connection, account: Account) -> dict[str, Camera]:
    found = {}
    for row in connection.execute(f"select {', '.join(TABLES['cameras'])} from cameras"):
        told = dict(zip(TABLES["cameras"], row))
        name = _text(told["name"])
        with account.part(f"camera {name}") as where:
            found[name] = camera_of(told | {kind: _text(told[kind]) for kind in ("model_type", "setup_type")}, where)
    return found


def _keyframes(
    path: Path, connection: sqlite3.Connection, cameras: dict[str, Camera], wanted: Wanted, account: Account
) -> Iterator[Observation]:
    count = connection.execute("select count(*) from keyframes").fetchone()[0]
    if count > MAX_KEYFRAMES:
        raise RevisitError(f"{path}: it has {count} keyframes; at most {MAX_KEYFRAMES} are taken")
    scale = wanted.metres_per_unit or 1.0
    names, placed = Names(wanted.name(path), cameras, scale), PointIds(str(path))
    rows = connection.execute(f"select {COLUMNS} from keyframes k left join associations a on a.id = k.id order by k.id")
    for row in rows:
        with account.part(f"keyframe {row[0]}") as where:
            seen = names.observation(_keyframe(row, where), where)
            new = placed.new_of(landmarks_of(seen))
            seen.placed.update(_positions(connection, new, scale, account))
            yield seen


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
        np.stack((points["x"], points["y"]), axis=1), points["octave"], points["angle"],
        np.frombuffer(described, np.uint8).reshape(count, DESCRIPTOR_BYTES),
        np.frombuffer(_column(landmarks, 4 * count, "landmarks", where), "<i4"),
        [int(edge) for edge in np.frombuffer(edges, "<i4")],
    )  # fmt: skip


def _column(value: Any, size: int, what: str, where: str) -> bytes:
    value = b"" if value is None else value
    if not isinstance(value, bytes) or len(value) != size:
        told = f"{len(value)} bytes" if isinstance(value, bytes) else "no blob"
        raise RevisitError(f"{where}: its {what} are {told}, not {size} bytes")
    return value


def _positions(connection: sqlite3.Connection, ids: list[int], scale: float, account: Account) -> dict[int, np.ndarray]:
    """Return where landmarks are; one that is nowhere counts for covisibility only, as stella_vslam skips it."""
    found = {}
    for start in range(0, len(ids), IDS_AT_ONCE):
        some = ids[start : start + IDS_AT_ONCE]
        for id, position in connection.execute(f"select id, pos_w from landmarks where id in ({','.join('?' * len(some))})", some):
            with account.part(f"landmark {id}") as where:
                if not isinstance(position, bytes) or len(position) != 3 * 8:
                    raise RevisitError(f"{where}: its position is not of three numbers")
                found[id] = checked(np.frombuffer(position, "<f8") * scale, where)
    return found


def _text(value: Any) -> str:
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)
