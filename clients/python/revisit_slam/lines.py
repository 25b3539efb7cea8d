"""Lines of an answer that arrives in pieces."""

from __future__ import annotations


class LineSplitter:
    """Cuts pieces at their newlines; each piece is copied once, however long a line is."""

    def __init__(self) -> None:
        self._begun: list[bytes] = []

    def feed(self, piece: bytes) -> list[bytes]:
        """Take a piece; return the lines that it completes, without their newlines."""
        first, *others = piece.split(b"\n")
        self._begun.append(first)
        if not others:
            return []
        lines = [b"".join(self._begun), *others[:-1]]
        self._begun = [others[-1]]
        return lines
