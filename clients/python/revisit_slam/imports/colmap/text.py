"""Text form of a COLMAP model: `cameras.txt`, `images.txt`, `points3D.txt`, an entry a line, an image two."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

import numpy as np

from ...errors import RevisitError
from ...files import MARKS
from ..damage import Account
from ..limits import MAX_KEYFRAMES, MAX_PIECE_BYTES
from ..point_store import signed
from .cameras import Camera, camera_of
from .image import Image


class TextModel:
    """A model's three files, open."""

    def __init__(self, model: Path) -> None:
        self._files = {name: Lines(model / f"{name}.txt") for name in ("cameras", "images", "points3D")}

    def cameras(self, account: Account) -> dict[int, Camera]:
        """Return the cameras by their ids; one that is wrong is left out."""
        file, found = self._files["cameras"], {}
        for line in file.entries():
            words = line.decode("utf-8", "replace").split()
            with file.told("CAMERA_ID MODEL WIDTH HEIGHT PARAMS.."):
                id, model, width, height = int(words[0]), words[1], int(words[2]), int(words[3])
            with account.part(f"camera {id}") as where:
                found[id] = camera_of(model, width, height, [number(word) for word in words[4:]], where)
        return found

    def points(self) -> Iterator[tuple[int, float, float, float]]:
        """Yield the points: id, x, y, z."""
        file = self._files["points3D"]
        for line in file.entries():
            words = line.split(None, 4)
            with file.told("POINT3D_ID X Y Z R G B ERROR TRACK.."):
                point = int(words[0]), number(words[1]), number(words[2]), number(words[3])
            yield point

    def images(self) -> Iterator[Image]:
        """Yield the images in the order of the file."""
        file, count = self._files["images"], 0
        for line in file.entries():
            words = line.decode("utf-8", "surrogateescape").split(None, 9)
            with file.told("IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME"):
                w, x, y, z, tx, ty, tz = (number(word) for word in words[1:8])
                camera, name, _ = int(words[8]), words[9].strip(), int(words[0])
            count += 1
            if count > MAX_KEYFRAMES:
                raise RevisitError(f"{file.path}: it has more than {MAX_KEYFRAMES} images; so many are not taken")
            offset = file.file.tell()
            file.line()
            yield Image(name, camera, (w, x, y, z), (tx, ty, tz), offset, 0)

    def observed(self, image: Image) -> np.ndarray:
        """Return the ids of the points that an image observes, feature by feature, with a sign; -1 where a feature has none."""
        file = self._files["images"]
        file.file.seek(image.offset)
        words = file.line().split()
        if len(words) % 3 or not all(word.lstrip(b"-").isdigit() for word in words[2::3]):
            raise RevisitError(f"{file.path}: the features of image {image.name} are no X Y POINT3D_ID ..")
        return np.array([signed(int(word)) for word in words[2::3]], np.int64)

    def close(self) -> None:
        """Close the files."""
        for file in self._files.values():
            file.file.close()


class Lines:
    """A file read line by line, that says which line is wrong."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._number = 0
        self.file: BinaryIO = path.open("rb")

    def entries(self) -> Iterator[bytes]:
        """Yield the lines from the first one that are neither empty nor a comment."""
        self._number = 0
        self.file.seek(0)
        first = self.file.read(4)
        mark, encoding = next((found for found in MARKS if first.startswith(found[0])), (b"", "utf-8"))
        if encoding != "utf-8":
            raise RevisitError(f"{self.path}: a text in {encoding.upper()}: save it as UTF-8")
        self.file.seek(len(mark))
        while line := self.line():
            if line.strip() and not line.lstrip().startswith(b"#"):
                yield line

    def line(self) -> bytes:
        """Return the next line; nothing at the end."""
        line = self.file.readline(MAX_PIECE_BYTES)
        self._number += 1
        if len(line) == MAX_PIECE_BYTES:
            raise RevisitError(f"{self.path}: line {self._number} is longer than {MAX_PIECE_BYTES >> 20} MiB")
        return line

    @contextmanager
    def told(self, form: str) -> Iterator[None]:
        """Say that the line at hand is none of a form, whatever goes wrong with it."""
        try:
            yield
        except (ValueError, IndexError) as error:
            raise RevisitError(f"{self.path}: line {self._number} is no {form}") from error


def number(word: str | bytes) -> float:
    """Return a number; what is none, as what Windows writes for a division by zero, is not a number."""
    try:
        return float(word)
    except ValueError:
        return float("nan")
