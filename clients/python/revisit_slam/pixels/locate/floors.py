"""Floors: where each photograph was taken, and whether it asks or is asked, from a CSV."""

from __future__ import annotations

import csv
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from ...errors import RevisitError
from ..frames import Frame

GALLERY, QUERY = "gallery", "query"
SPLITS = (GALLERY, QUERY)


@dataclass(frozen=True)
class Row:
    """What the CSV says of one photograph."""

    floor: str
    split: str


class Floors:
    """The rows of a CSV with the columns `frame`, `floor` and, where one folder holds both, `split`."""

    def __init__(self, path: Path, with_split: bool) -> None:
        self._path = path
        self._rows: dict[str, Row] = {}
        needed = ["frame", "floor", *(["split"] if with_split else [])]
        try:
            with path.open(newline="", encoding="utf-8") as file:
                reader = csv.DictReader(file)
                missing = [column for column in needed if column not in (reader.fieldnames or ())]
                if missing:
                    raise RevisitError(f"{path}: its first line has no column `{missing[0]}`")
                for row in reader:
                    self._take(row, reader.line_num, with_split)
        except OSError as error:
            raise RevisitError(f"{path}: cannot be read: {error.strerror}") from error
        except (UnicodeDecodeError, csv.Error) as error:
            raise RevisitError(f"{path}: cannot be read: {error}") from error

    def _take(self, row: dict[str, str | None], line: int, with_split: bool) -> None:
        frame, floor, split = ((row.get(column) or "").strip() for column in ("frame", "floor", "split"))
        if not frame or not floor:
            raise RevisitError(f"{self._path}, line {line}: `frame` and `floor` must not be empty")
        if with_split and split not in SPLITS:
            raise RevisitError(f"{self._path}, line {line}: `split` is `{split}`; known are {GALLERY} and {QUERY}")
        name = _stem(frame)
        if self._rows.setdefault(name, Row(floor, split)) != Row(floor, split):
            raise RevisitError(f"{self._path}, line {line}: {frame} stands there twice, with different values")

    def of(self, frame: Frame) -> Row:
        """Return the row of a photograph."""
        row = next((self._rows[name] for name in (frame.id, frame.path.stem) if name in self._rows), None)
        if row is None:
            raise RevisitError(f"{self._path}: no row for {frame.path.name}")
        return row

    def split(self, frames: Iterable[Frame]) -> tuple[list[Frame], list[Frame]]:
        """Return the photographs of the gallery, and those that ask."""
        parts: dict[str, list[Frame]] = {GALLERY: [], QUERY: []}
        for frame in frames:
            parts[self.of(frame).split].append(frame)
        for name, part in parts.items():
            if not part:
                raise RevisitError(f"{self._path}: no photograph of the folder has the split {name}")
        return parts[GALLERY], parts[QUERY]


def _stem(name: str) -> str:
    """Return the name of a photograph without its folder and its ending; a number after a dot is no ending."""
    last = name.replace("\\", "/").rsplit("/", 1)[-1]
    stem, dot, ending = last.rpartition(".")
    return stem if dot and ending.lower() in {"jpg", "jpeg", "png", "bmp", "webp", "tif", "tiff"} else last
