"""Binary form of a COLMAP model: `cameras.bin`, `images.bin`, `points3D.bin`, little-endian."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from ...errors import RevisitError
from ..damage import Account
from ..limits import MAX_KEYFRAMES, MAX_PIECE_BYTES
from .cameras import Camera, camera_of, parameter_count
from .image import Image

COUNT = struct.Struct("<Q")
CAMERA = struct.Struct("<iiQQ")
IMAGE = struct.Struct("<I4d3dI")
FEATURE = np.dtype([("x", "<f8"), ("y", "<f8"), ("point", "<i8")])
POINT = struct.Struct("<Q3d3BdQ")
TRACK_BYTES = 8
MAX_NAME_BYTES = 4096


class BinaryModel:
    """A model's three files, open."""

    def __init__(self, model: Path) -> None:
        self._files = {name: File(model / f"{name}.bin") for name in ("cameras", "images", "points3D")}

    def cameras(self, account: Account) -> dict[int, Camera]:
        """Return the cameras by their ids; one that is wrong is left out."""
        file, found = self._files["cameras"], {}
        for _ in range(file.count("cameras", CAMERA.size)):
            id, model, width, height = file.unpack(CAMERA)
            params = file.read(8 * parameter_count(model, f"{file.path}: camera {id}"))
            with account.part(f"camera {id}") as where:
                found[id] = camera_of(model, width, height, list(np.frombuffer(params, "<f8")), where)
        return found

    def points(self) -> Iterator[tuple[int, float, float, float]]:
        """Yield the points: id, x, y, z."""
        file = self._files["points3D"]
        for _ in range(file.count("points", POINT.size)):
            id, x, y, z, _, _, _, _, track = file.unpack(POINT)
            file.skip(track * TRACK_BYTES)
            yield id, x, y, z

    def images(self) -> Iterator[Image]:
        """Yield the images in the order of the file."""
        file = self._files["images"]
        count = file.count("images", IMAGE.size)
        if count > MAX_KEYFRAMES:
            raise RevisitError(f"{file.path}: it has {count} images; at most {MAX_KEYFRAMES} are taken")
        for _ in range(count):
            _, w, x, y, z, tx, ty, tz, camera = file.unpack(IMAGE)
            name = file.text()
            features = COUNT.unpack(file.read(COUNT.size))[0]
            offset = file.file.tell()
            file.skip(features * FEATURE.itemsize)
            yield Image(name, camera, (w, x, y, z), (tx, ty, tz), offset, features)

    def observed(self, image: Image) -> np.ndarray:
        """Return the ids of the points that an image observes, feature by feature, with a sign; -1 where a feature has none."""
        file, size = self._files["images"], image.observations * FEATURE.itemsize
        if size > MAX_PIECE_BYTES:
            raise RevisitError(f"{file.path}: image {image.name} has {image.observations} features; that is no image")
        file.file.seek(image.offset)
        return np.frombuffer(file.read(size), FEATURE)["point"]

    def close(self) -> None:
        """Close the files."""
        for file in self._files.values():
            file.file.close()


class File:
    """A file read in order, that says where it ends too early."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._size = path.stat().st_size
        self.file: BinaryIO = path.open("rb")

    def count(self, what: str, least_bytes: int) -> int:
        """Return the number of entries that the file begins with, which it must have room for."""
        self.file.seek(0)
        count = COUNT.unpack(self.read(COUNT.size))[0]
        if count * least_bytes > self._size:
            raise RevisitError(f"{self.path}: it claims {count} {what}, and has {self._size} bytes")
        return count

    def unpack(self, form: struct.Struct) -> tuple[Any, ...]:
        """Return the numbers that come next."""
        return form.unpack(self.read(form.size))

    def read(self, size: int) -> bytes:
        """Return the bytes that come next."""
        data = self.file.read(size)
        if len(data) < size:
            raise RevisitError(f"{self.path}: it ends in the middle of an entry, after {self._size} bytes")
        return data

    def skip(self, size: int) -> None:
        """Leave bytes out."""
        if self.file.tell() + size > self._size:
            raise RevisitError(f"{self.path}: it ends in the middle of an entry, after {self._size} bytes")
        self.file.seek(size, 1)

    def text(self) -> str:
        """Return the text up to the next zero byte."""
        begun = self.file.tell()
        data = self.file.read(MAX_NAME_BYTES)
        end = data.find(b"\0")
        if end < 0:
            raise RevisitError(f"{self.path}: at byte {begun} an image's name does not end")
        self.file.seek(begun + end + 1)
        return data[:end].decode("utf-8", "surrogateescape")
