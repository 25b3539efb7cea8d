"""RTAB-Map database: nodes with their optimised poses, features and links.

Of the pictures, depths, scans and grids in it nothing is read.
"""

from __future__ import annotations

import re
import sqlite3
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import RevisitError
from ..damage import Account
from ..limits import MAX_DETECTIONS, MAX_FEATURES, MAX_KEYFRAMES
from ..observation import Observation
from ..opened import Opened, Wanted
from ..sqlite_file import need_columns, reading
from .blobs import POSE_FLOATS, camera_of, floats_camera_of, matrix_of, pose_of
from .node import (
    ASSUMED_SIDE_M, LANDMARK, MAX_WORD, Landmarks, Mounted, Nodes, Words, observation, usable_descriptors, without_features
)  # fmt: skip

FEATURE = ("word_id", "pos_x", "pos_y", "dir", "octave", "depth_x", "depth_y", "depth_z", "descriptor_size", "descriptor")
TABLES = {
    "Admin": ("version",),
    "Node": ("id", "map_id", "weight", "stamp", "pose"),
    "Data": ("id", "calibration"),
    "Link": ("from_id", "to_id", "type", "transform", "user_data"),
    "Feature": ("node_id", *FEATURE),
}
# Since then a calibration says how long it is.
SERIALIZED_CALIBRATION = (0, 18, 0)
MAX_TOLD = 12
MAX_NODE_ID = 2**31 - 1
# A tag that is larger is none.
MAX_SIDE_M = 10.0


def open_map(path: Path, wanted: Wanted) -> Opened:
    """Open a database."""
    need_columns(path, TABLES, "database of RTAB-Map 0.13 and later (open an older one with it once)")
    account = Account(path)

    def keyframes() -> Iterator[Observation]:
        with reading(path) as connection:
            yield from Database(path, connection, wanted, account).keyframes()

    return Opened("RTAB-Map database", True, keyframes, account)


class Database:
    """A database that is open."""

    def __init__(self, path: Path, connection: sqlite3.Connection, wanted: Wanted, account: Account) -> None:
        self._path, self._connection, self._account = path, connection, account
        self._name = wanted.name(path)
        self._floats_only = self._version() < SERIALIZED_CALIBRATION
        self._nodes = Nodes()
        self._without = Counter[str]()
        self._several = 0

    def keyframes(self) -> Iterator[Observation]:
        """Yield the nodes in the order of their numbers, which is that of time."""
        optimised = self._optimised()
        maps, joined = self._maps(optimised)
        if not optimised:
            self._account.notes.append("no optimised poses in it: they are those of odometry")
        elif maps - joined:
            told = ", ".join(f"{self._name}-{map_id}" for map_id in sorted(maps - joined)[:MAX_TOLD])
            self._account.notes.append(f"not joined with the optimised graph, and of odometry's poses: {told}")
        for id, map_id, weight, stamp, pose in self._connection.execute("select id, map_id, weight, stamp, pose from Node order by id"):
            if len(self._nodes.names) >= MAX_KEYFRAMES:
                raise RevisitError(f"{self._path}: it has more than {MAX_KEYFRAMES} nodes; so many are not taken")
            with self._account.part(f"node {id}") as where:
                if not isinstance(id, int) or not 0 < id <= MAX_NODE_ID or not isinstance(map_id, int):
                    raise RevisitError(f"{where} of map {map_id} has no number that a node has")
                if weight is not None and weight < 0:
                    raise RevisitError(f"{where}: between keyframes, without features")
                # Poses of odometry are of another frame: of the two only one is taken in a session.
                is_optimised = map_id in joined
                map_from_base = pose_of(optimised.get(id) if is_optimised else pose, where)
                if map_from_base is None:
                    raise RevisitError(f"{where}: without an optimised pose" if is_optimised else f"{where}: without a pose")
                yield self._keyframe(id, map_id, stamp, map_from_base, where)
            if id not in self._nodes.names:
                self._nodes.leave_out(id, self._links(id))
        for why, count in self._without.items():
            self._account.notes.append(f"{count} keyframes have words, but no features: {why}")
        if self._several:
            self._account.notes.append(f"of {self._several} keyframes with several cameras only the first camera's features are taken")

    def _maps(self, optimised: dict[int, bytes]) -> tuple[set[int], set[int]]:
        """Return the maps, and those that the optimised graph joins: RTAB-Map keeps it of the last map and what is linked to it."""
        maps, joined = set[int](), set[int]()
        for id, map_id in self._connection.execute("select id, map_id from Node"):
            # Of what is no number the node is left out.
            if isinstance(map_id, int):
                maps.add(map_id)
                if id in optimised:
                    joined.add(map_id)
        return maps, joined

    def _keyframe(self, id: int, map_id: int, stamp: Any, map_from_base: np.ndarray, where: str) -> Observation:
        words, mounted, landmarks = self._words(id, where), self._mounted(id, where), self._landmarks(id, where)
        seen = observation(f"{self._name}-{map_id}", id, stamp, map_from_base, mounted, words, landmarks)
        why = without_features(mounted, words)
        self._without.update([why] if why else [])
        self._several += mounted.cameras > 1
        self._nodes.join(id, seen, self._links(id))
        return seen

    def _links(self, id: int) -> Iterator[tuple[int, int]]:
        return self._connection.execute("select to_id, type from Link where from_id = ? order by to_id", (id,))

    def _version(self) -> tuple[int, ...]:
        row = self._connection.execute("select version from Admin").fetchone()
        told = str(row[0]) if row else "none"
        if not re.fullmatch(r"\d{1,4}(\.\d{1,4}){1,3}", told):
            raise RevisitError(f"{self._path}: RTAB-Map's version in it is {told[:40]!r}, which is none")
        return tuple(int(part) for part in told.split("."))

    def _optimised(self) -> dict[int, bytes]:
        """Return `map_from_base` of the nodes of the optimised graph, as the nodes have their own."""
        if not {"opt_ids", "opt_poses"} <= {row[1] for row in self._connection.execute("pragma table_info(Admin)")}:
            return {}
        ids, poses = self._connection.execute("select opt_ids, opt_poses from Admin").fetchone()
        if not ids or not poses:
            return {}
        where = f"{self._path}: the optimised poses"
        if not isinstance(ids, bytes) or not isinstance(poses, bytes):
            raise RevisitError(f"{where} are no blobs")
        numbers, rows = matrix_of(ids, where).ravel(), matrix_of(poses, where).ravel()
        if numbers.dtype != np.int32 or rows.dtype != np.float32 or len(rows) != POSE_FLOATS * len(numbers):
            raise RevisitError(f"{where} are {len(rows)} numbers for {len(numbers)} nodes, not 12 floats each")
        return {int(id): row.tobytes() for id, row in zip(numbers, rows.reshape(-1, POSE_FLOATS)) if row.any()}

    def _mounted(self, id: int, where: str) -> Mounted:
        row = self._connection.execute("select calibration from Data where id = ?", (id,)).fetchone()
        if row is None or not row[0]:
            return Mounted(None, np.eye(4))
        if not isinstance(row[0], bytes):
            raise RevisitError(f"{where}: its calibration is no blob")
        return Mounted(*(floats_camera_of if self._floats_only else camera_of)(row[0], where))

    def _landmarks(self, id: int, where: str) -> Landmarks:
        rows = self._connection.execute(
            "select to_id, transform, user_data from Link where from_id = ? and type = ? and to_id < 0 order by to_id limit ?",
            (id, LANDMARK, MAX_DETECTIONS),
        )
        found = ((number, pose_of(place, f"{where}: landmark {number}"), side) for number, place, side in rows)
        return [(number, place, _side_m(side, f"{where}: landmark {number}")) for number, place, side in found if place is not None]

    def _words(self, id: int, where: str) -> Words:
        columns = ", ".join(FEATURE)
        rows = self._connection.execute(
            f"select {columns} from Feature where node_id = ? order by rowid limit ?", (id, MAX_FEATURES + 1)
        ).fetchall()
        if len(rows) > MAX_FEATURES:
            raise RevisitError(f"{where} has more than {MAX_FEATURES} features; so many are not taken")
        try:
            # What is null there is no number here.
            numbers = np.array([row[:8] for row in rows], float).reshape(-1, 8)
        except (TypeError, ValueError) as error:
            raise RevisitError(f"{where}: a feature's numbers are of another kind") from error
        ids, octaves = np.nan_to_num(numbers[:, [0, 4]]).clip(-1, MAX_WORD + 1).astype(np.int64).T
        # 32-bit floats in RTAB-Map itself, and so in the recording.
        pixels, angles_deg = numbers[:, 1:3].astype(np.float32), numbers[:, 3].astype(np.float32)
        return Words(ids, pixels, octaves, angles_deg, numbers[:, 5:], _descriptors(rows, where))


def _side_m(blob: object, where: str) -> float:
    """Return the side of a tag, which RTAB-Map keeps as the link's user data."""
    if not isinstance(blob, bytes) or not blob:
        return ASSUMED_SIDE_M
    sides = matrix_of(blob, where).ravel()
    return float(sides[0]) if sides.dtype == np.float32 and len(sides) == 1 and 0 < sides[0] <= MAX_SIDE_M else ASSUMED_SIDE_M


def _descriptors(rows: list[tuple[Any, ...]], where: str) -> np.ndarray | None:
    """Return the descriptors of features; RTAB-Map keeps as many bytes as numbers where they are binary."""
    if not rows or any(not isinstance(row[9], bytes) or not row[9] or row[8] != len(row[9]) for row in rows):
        return None
    if len({len(row[9]) for row in rows}) != 1:
        raise RevisitError(f"{where}: its descriptors are of several lengths")
    return usable_descriptors(np.frombuffer(b"".join(row[9] for row in rows), np.uint8).reshape(len(rows), -1))
