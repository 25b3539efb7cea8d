"""Blobs of RTAB-Map: matrices and cameras as its databases and messages keep them."""

from __future__ import annotations

import struct
import zlib

import numpy as np

from ...errors import RevisitError
from ...pixels.pinhole import Pinhole
from ..limits import MAX_PIECE_BYTES
from ..poses import rigid

# A matrix of OpenCV, compressed by zlib; rows, columns and type come after it.
MATRIX_TAIL = struct.Struct("<iii")
# OpenCV's number of an element's type, for one channel.
DEPTHS = {0: "<u1", 1: "<i1", 2: "<u2", 3: "<i2", 4: "<i4", 5: "<f4", 6: "<f8"}
# A camera: version (three numbers), 0, width, height, how many numbers K, D, R, P have, and those of its place.
MONO_HEADER = struct.Struct("<11i")
# A stereo pair: version, 1, how many numbers R, T, E and F have, bytes of the left and the right camera.
STEREO_HEADER = struct.Struct("<10i")
KIND_AT = struct.Struct("<12xi")
MONO, STEREO = 0, 1
POSE_FLOATS = 12


def matrix_of(blob: bytes, where: str) -> np.ndarray:
    """Return a compressed matrix, of one channel."""
    if len(blob) < MATRIX_TAIL.size:
        raise RevisitError(f"{where}: {len(blob)} bytes are no compressed matrix")
    rows, columns, kind = MATRIX_TAIL.unpack_from(blob, len(blob) - MATRIX_TAIL.size)
    if kind not in DEPTHS or rows < 0 or columns < 0:
        raise RevisitError(f"{where}: a matrix of {rows} x {columns} elements of type {kind} is none")
    dtype = np.dtype(DEPTHS[kind])
    size = rows * columns * dtype.itemsize
    if size > MAX_PIECE_BYTES:
        raise RevisitError(f"{where}: it claims a matrix of {rows} x {columns}, which is larger than {MAX_PIECE_BYTES >> 20} MiB")
    inflater = zlib.decompressobj()
    try:
        # One byte more than it claims, to see that there is none.
        data = inflater.decompress(blob[: -MATRIX_TAIL.size], size + 1)
    except zlib.error as error:
        raise RevisitError(f"{where}: a matrix in it does not decompress: {error}") from error
    if len(data) != size:
        raise RevisitError(f"{where}: a matrix of {rows} x {columns} does not decompress to its {size} bytes")
    return np.frombuffer(data, dtype).reshape(rows, columns)


def pose_of(blob: object, where: str) -> np.ndarray | None:
    """Return a pose kept as 3 x 4 floats, row by row; None where it is null, which RTAB-Map writes as zeros or as nothing."""
    if blob is None or blob == b"":
        return None
    if not isinstance(blob, bytes) or len(blob) != 4 * POSE_FLOATS:
        raise RevisitError(f"{where}: its pose is not of 12 floats")
    numbers = np.frombuffer(blob, "<f4")
    return None if not numbers.any() else rigid(numbers, where)


def camera_of(blob: bytes, where: str) -> tuple[Pinhole | None, np.ndarray, int]:
    """Return the first camera of a calibration, `base_from_camera`, and how many cameras there are.

    Pictures are rectified where RTAB-Map takes features, so the camera is its projection P, or K where there is no P.
    """
    kind = KIND_AT.unpack_from(blob)[0] if len(blob) >= KIND_AT.size else None
    header, one = {MONO: (MONO_HEADER, _mono), STEREO: (STEREO_HEADER, _stereo)}.get(kind, (None, None))
    if header is None or one is None or len(blob) < header.size:
        raise RevisitError(f"{where}: its calibration of {len(blob)} bytes is of no form that is known")
    camera, base_from_camera, size = one(blob, where)
    cameras, rest = 1, blob[size:]
    while len(rest) >= header.size:
        _, _, size = one(rest, where)
        cameras, rest = cameras + 1, rest[size:]
    return camera, base_from_camera, cameras


def _stereo(blob: bytes, where: str) -> tuple[Pinhole | None, np.ndarray, int]:
    """Return the left camera of a pair."""
    *_, r, t, e, f, left, right = STEREO_HEADER.unpack_from(blob)
    begun = STEREO_HEADER.size + 8 * (r + t + e + f)
    if min(r, t, e, f, right) < 0 or left < MONO_HEADER.size or begun + left + right > len(blob):
        raise RevisitError(f"{where}: its calibration of two cameras is cut off")
    camera, base_from_camera, _ = _mono(blob[begun : begun + left], where)
    return camera, base_from_camera, begun + left + right


def _mono(blob: bytes, where: str) -> tuple[Pinhole | None, np.ndarray, int]:
    _, _, _, _, width, height, k, d, r, p, place = MONO_HEADER.unpack_from(blob)
    size = MONO_HEADER.size + 8 * (k + d + r + p) + 4 * place
    if k not in (0, 9) or p not in (0, 12) or r not in (0, 9) or place not in (0, POSE_FLOATS) or not 0 <= d <= 14 or size > len(blob):
        raise RevisitError(f"{where}: its calibration is cut off, or of no form that is known")
    numbers = np.frombuffer(blob, "<f8", k + d + r + p, MONO_HEADER.size)
    placed = pose_of(blob[size - 4 * place : size], f"{where}: the camera's place on the base")
    base_from_camera = np.eye(4) if placed is None else placed
    if p:
        fx, cx, fy, cy = numbers[k + d + r :][[0, 2, 5, 6]]
    elif k:
        fx, cx, fy, cy = numbers[[0, 2, 4, 5]]
    else:
        return None, base_from_camera, size
    if not width or not height:
        return None, base_from_camera, size
    return Pinhole(float(fx), float(fy), float(cx), float(cy), width, height).checked(where), base_from_camera, size


def floats_camera_of(blob: bytes, where: str) -> tuple[Pinhole | None, np.ndarray, int]:
    """Return the same of a calibration before RTAB-Map 0.18: fx, fy, cx, cy, [baseline,] width, height, place, as floats."""
    numbers = np.frombuffer(blob[: len(blob) // 4 * 4], "<f4")
    for length, size_at in ((6 + POSE_FLOATS, 4), (7 + POSE_FLOATS, 5)):
        if len(numbers) and len(numbers) % length == 0:
            fx, fy, cx, cy = (float(number) for number in numbers[:4])
            width, height = (int(number) if np.isfinite(number) else 0 for number in numbers[size_at : size_at + 2])
            camera = Pinhole(fx, fy, cx, cy, width, height).checked(where) if width and height else None
            place = rigid(numbers[length - POSE_FLOATS : length], f"{where}: the camera's place on the base")
            return camera, place, len(numbers) // length
    raise RevisitError(f"{where}: its calibration of {len(blob)} bytes is of no form that is known")
