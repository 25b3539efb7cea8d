"""MessagePack map of stella_vslam: `cameras`, `keyframes`, `landmarks`, each a map by name or number.

It is read three times, each time an entry at once: landmarks stand after the keyframes that observe them, and keyframes
in the order of their numbers as texts.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from ...errors import RevisitError
from ...needed import needed
from ..damage import Account, told_of
from ..limits import MAX_KEYFRAMES, MAX_PIECE_BYTES
from ..observation import Features, Observation
from ..opened import Opened, Wanted
from ..point_store import PointStore
from ..poses import matrix
from .camera import Camera, camera_of, opened
from .keyframe import MAX_KEYFRAME_ID, Keyframe, Names

READER = "the reader of MessagePack"
READ_BYTES = 64 << 10
SECTIONS = ("cameras", "keyframes", "landmarks")
KEYS = ("ts", "cam", "rot_cw", "trans_cw", "undist_keypts", "descs", "lm_ids", "loop_edges")


def open_map(path: Path, wanted: Wanted) -> Opened:
    """Open a map."""
    account = Account(path)
    cameras: dict[str, Camera] = {}
    offsets: dict[int, int] = {}

    def camera(name: str, unpacker: Any, _: int) -> None:
        told = unpacker.unpack()
        with account.part(f"camera {name[:40]}") as where:
            if not isinstance(told, Mapping) or not {"model_type", "setup_type"} <= set(told):
                raise RevisitError(f"{where} has no model and setup")
            missing = {name: None for name in ("fx", "fy", "cx", "cy", "cols", "rows")}
            cameras[name] = camera_of({**missing, **told}, where)

    def keyframe(name: str, unpacker: Any, offset: int) -> None:
        with account.part(f"keyframe {name[:40]}") as where:
            offsets[_number(name, where)] = offset
        if len(offsets) > MAX_KEYFRAMES:
            raise RevisitError(f"{path}: it has more than {MAX_KEYFRAMES} keyframes; so many are not taken")
        unpacker.skip()

    _walk(path, {"cameras": camera, "keyframes": keyframe})
    return opened(cameras, wanted, lambda: _keyframes(path, offsets, cameras, wanted, account), account)


def _keyframes(
    path: Path, offsets: dict[int, int], cameras: dict[str, Camera], wanted: Wanted, account: Account
) -> Iterator[Observation]:
    scale = wanted.metres_per_unit or 1.0

    def landmark(name: str, unpacker: Any, _: int) -> None:
        told = unpacker.unpack()
        with account.part(f"landmark {name[:40]}") as where:
            position = told.get("pos_w") if isinstance(told, Mapping) else None
            points.add(_number(name, where), *(scale * value for value in _numbers(position, 3, "position", where)))

    with told_of(path, READER), path.open("rb") as file, PointStore(account) as points:
        _walk(path, {"landmarks": landmark})
        names = Names(wanted.name(path), cameras, points, scale)
        for id in sorted(offsets):
            with account.part(f"keyframe {id}") as where:
                file.seek(offsets[id])
                yield names.observation(_keyframe(id, _unpacker(file).unpack(), where), where)


def _keyframe(id: int, told: Any, where: str) -> Keyframe:
    missing = [key for key in KEYS if key not in told] if isinstance(told, Mapping) else list(KEYS)
    if missing:
        raise RevisitError(f"{where} has no {missing[0]}")
    keypoints, descriptors = told["undist_keypts"] or [], told["descs"] or []
    try:
        pixels = np.array([keypoint["pt"] for keypoint in keypoints], np.float32).reshape(len(keypoints), 2)
        octaves = np.array([keypoint["oct"] for keypoint in keypoints], np.int64)
        angles = np.array([keypoint["ang"] for keypoint in keypoints], np.float32)
        described = np.array(descriptors, "<u4").reshape(len(descriptors), 8)
        landmarks = np.array(told["lm_ids"] or [], np.int64)
        edges = [int(edge) for edge in told["loop_edges"] or []]
    except (KeyError, TypeError, ValueError, OverflowError) as error:
        raise RevisitError(f"{where}: its keypoints, descriptors, landmarks or edges are of another form") from error
    xyzw = _numbers(told["rot_cw"], 4, "rotation", where)
    pose = matrix(_numbers(told["trans_cw"], 3, "translation", where), xyzw, where)
    stamp_s = _numbers([told["ts"]], 1, "time", where)[0]
    return Keyframe(
        id, stamp_s, str(told["cam"]), pose, Features(pixels, octaves, angles, described.view(np.uint8), landmarks), edges,
    )  # fmt: skip


def _walk(path: Path, visits: Mapping[str, Callable[[str, Any, int], None]]) -> None:
    """Go through the entries of the named sections, one at a time."""
    with told_of(path, READER), path.open("rb") as file:
        unpacker, seen = _unpacker(file), []
        for _ in range(unpacker.read_map_header()):
            section = unpacker.unpack()
            seen.append(section)
            if section not in visits:
                unpacker.skip()
                continue
            for _ in range(_entries(unpacker)):
                name = unpacker.unpack()
                if not isinstance(name, str):
                    raise RevisitError(f"{path}: an entry of its {section} has no name")
                visits[section](name, unpacker, unpacker.tell())
        missing = [section for section in SECTIONS if section not in seen]
        if missing:
            raise RevisitError(f"{path}: no {missing[0]} in it, which the MessagePack map of stella_vslam has")


def _entries(unpacker: Any) -> int:
    """Return the number of a section's entries; an empty one is written as nil."""
    try:
        return int(unpacker.read_map_header())
    except ValueError as error:
        raise RevisitError("a section is no map") from error


def _unpacker(file: BinaryIO) -> Any:
    msgpack = needed("msgpack")
    return msgpack.Unpacker(file, read_size=READ_BYTES, max_buffer_size=MAX_PIECE_BYTES, strict_map_key=False)


def _number(name: str, where: str) -> int:
    if not name.isascii() or not name.isdigit() or len(name) > 10 or int(name) > MAX_KEYFRAME_ID:
        raise RevisitError(f"{where}: its number is none")
    return int(name)


def _numbers(values: Any, count: int, what: str, where: str) -> list[float]:
    good = isinstance(values, list) and len(values) == count
    if not good or any(isinstance(value, bool) or not isinstance(value, (int, float)) for value in values):
        raise RevisitError(f"{where}: its {what} is not of {count} numbers")
    return [float(value) for value in values]
