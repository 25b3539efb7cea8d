"""Recording: what `revisit replay` plays, written line by line."""

from __future__ import annotations

from pathlib import Path
from types import TracebackType
from typing import Any

import msgspec
import zstandard

from ..errors import RevisitError


class Recording:
    """An NDJSON file of operations, compressed where its name ends in .zst; whole only once it is closed."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._part = path.with_name(path.name + ".part")
        try:
            self._raw = self._part.open("wb")
        except OSError as error:
            raise RevisitError(f"{path}: cannot be written: {error.strerror}") from error
        self._file: Any = self._raw
        if path.suffix == ".zst":
            self._file = zstandard.ZstdCompressor(level=10).stream_writer(self._raw, closefd=False)

    def write(self, op: str, **line: Any) -> None:
        """Write an operation; the map that all later ones belong to comes first."""
        self._file.write(msgspec.json.encode({"op": op, **line}) + b"\n")

    def query(self, keyframe: str, truth: tuple[list[str], list[str]] | None) -> None:
        """Write a query, with the keyframes that are right and those that are not scored."""
        judged = {} if truth is None else {"truth": truth[0], "ignore": truth[1]}
        self.write("query", keyframe=keyframe, body={"verify": "auto"}, **judged)

    def __enter__(self) -> Recording:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        if self._file is not self._raw:
            self._file.close()
        self._raw.close()
        if kind is None:
            self._part.replace(self._path)
        else:
            self._part.unlink(missing_ok=True)
