"""A bounded queue of lines in a file."""

from __future__ import annotations

import os
from pathlib import Path


class Spill:
    """First in, first out; the file is emptied once all of it was read."""

    def __init__(self, path: Path, max_bytes: int) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        self._path = path
        self._max_bytes = max_bytes
        self._file = path.open("a+b")
        self._end = self._file.seek(0, os.SEEK_END)
        self._read = 0
        self._file.seek(0)
        # A file that an earlier run left: its lines are sent first. A line cut short by a crash is dropped.
        self.count = 0
        whole = 0
        for line in self._file:
            if line.endswith(b"\n"):
                self.count += 1
                whole += len(line)
        if whole < self._end:
            self._file.truncate(whole)
            self._end = whole

    def append(self, line: bytes, beyond: bool = False) -> bool:
        """Append a line without a line break in it; False where the file is full or cannot be written."""
        if not beyond and self._end + len(line) + 1 > self._max_bytes:
            return False
        try:
            self._file.seek(0, os.SEEK_END)
            self._file.write(line + b"\n")
            self._file.flush()
        except OSError:
            # A full disk may leave half a line.
            self._file.truncate(self._end)
            return False
        self._end += len(line) + 1
        self.count += 1
        return True

    def take(self, max_lines: int) -> list[bytes]:
        """Remove and return the oldest lines."""
        self._file.seek(self._read)
        lines = []
        while self.count > 0 and len(lines) < max_lines:
            line = self._file.readline()
            self._read += len(line)
            self.count -= 1
            lines.append(line.rstrip(b"\n"))
        if self.count == 0:
            self._file.truncate(0)
            self._read = self._end = 0
        return lines

    def put_back(self, lines: list[bytes]) -> None:
        """Write `lines` before all others; for closing, where nothing is taken any more."""
        rest = self.take(self.count) if self.count else []
        self._file.truncate(0)
        self._read = self._end = 0
        # What memory held is bounded too: at closing it may go beyond the file's own bound.
        for line in lines + rest:
            self.append(line, beyond=True)

    def close(self) -> None:
        """Close the file, and remove it where nothing is left in it."""
        self._file.close()
        if self.count == 0:
            self._path.unlink(missing_ok=True)
