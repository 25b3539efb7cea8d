"""Text form of a COLMAP model: `cameras.txt`, `images.txt`, `points3D.txt`, an entry a line, an image two."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

import numpy as np

from ...errors import RevisitError
from ..limits import MAX_KEYFRAMES, MAX_PIECE_BYTES
from .cameras import pinhole
from .entries import Camera, Image, model_file


class TextModel:
    """A model's three files, open."""

    def __init__(self, model: Path) -> None:
        self._files = {name: Lines(model_file(model, name, "txt")) for name in ("cameras", "images", "points3D")}

    def cameras(self) -> dict[int, Camera]:
        """Return the cameras by their ids."""
        file, found = self._files["cameras"], {}
        for line in file.entries():
            words = line.decode("utf-8", "replace").split()
            with file.told("CAMERA_ID MODEL WIDTH HEIGHT PARAMS.."):
                id, width, height, params = int(words[0]), int(words[2]), int(words[3]), [float(word) for word in words[4:]]
            found[id] = Camera(*pinhole(words[1], width, height, params, f"{file.path}: camera {id}"))
        return found

    def points(self) -> Iterator[tuple[int, float, float, float]]:
        """Yield the points: id, x, y, z."""
        file = self._files["points3D"]
        for line in file.entries():
            words = line.split(None, 4)
            with file.told("POINT3D_ID X Y Z R G B ERROR TRACK.."):
                point = int(words[0]), float(words[1]), float(words[2]), float(words[3])
            yield point

    def images(self) -> Iterator[Image]:
        """Yield the images in the order of the file."""
        file, count = self._files["images"], 0
        for line in file.entries():
            words = line.decode("utf-8", "replace").split(None, 9)
            with file.told("IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME"):
                w, x, y, z, tx, ty, tz = (float(word) for word in words[1:8])
                camera, name, _ = int(words[8]), words[9].strip(), int(words[0])
            count += 1
            if count > MAX_KEYFRAMES:
                raise RevisitError(f"{file.path}: it has more than {MAX_KEYFRAMES} images; so many are not taken")
            offset = file.tell()
            file.line()
            yield Image(name, camera, (w, x, y, z), (tx, ty, tz), offset, 0)

    def observed(self, image: Image) -> np.ndarray:
        """Return the ids of the points that an image observes, feature by feature; -1 where a feature has none."""
        file = self._files["images"]
        file.seek(image.offset)
        words = file.line().split()
        try:
            ids = [int(word) for word in words[2::3]]
        except ValueError:
            ids = [-2]
        if len(words) % 3 or min(ids, default=-1) < -1:
            raise RevisitError(f"{file.path}: the features of image {image.name} are no X Y POINT3D_ID ..")
        return np.array(ids, np.int64)

    def close(self) -> None:
        """Close the files."""
        for file in self._files.values():
            file.close()


class Lines:
    """A file read line by line, that says which line is wrong."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._number = 0
        self._file: BinaryIO = path.open("rb")

    def entries(self) -> Iterator[bytes]:
        """Yield the lines from the first one that are neither empty nor a comment."""
        self._file.seek(0)
        self._number = 0
        while line := self.line():
            if line.strip() and not line.lstrip().startswith(b"#"):
                yield line

    def line(self) -> bytes:
        """Return the next line; nothing at the end."""
        line = self._file.readline(MAX_PIECE_BYTES)
        self._number += 1
        if len(line) == MAX_PIECE_BYTES:
            raise RevisitError(f"{self.path}: line {self._number} is longer than {MAX_PIECE_BYTES >> 20} MiB")
        return line

    def told(self, form: str) -> LineError:
        """Say that the line at hand is none of a form, whatever goes wrong with it."""
        return LineError(f"{self.path}: line {self._number} is no {form}")

    def tell(self) -> int:
        """Return where the next line begins."""
        return self._file.tell()

    def seek(self, offset: int) -> None:
        """Go to the beginning of a line."""
        self._file.seek(offset)

    def close(self) -> None:
        """Close it."""
        self._file.close()


class LineError:
    """Turns what a wrong line leads to into one sentence."""

    def __init__(self, sentence: str) -> None:
        self._sentence = sentence

    def __enter__(self) -> None:
        pass

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: object) -> None:
        if isinstance(error, (ValueError, IndexError)):
            raise RevisitError(self._sentence) from error
