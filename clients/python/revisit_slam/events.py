"""Server-sent events: the parser, and where a broken stream resumes."""

from __future__ import annotations

import msgspec

from .models import Event


class EventParser:
    """Turns lines of a stream into events, and remembers the number of the last one."""

    def __init__(self, since: int) -> None:
        self.last = since
        self._data: list[str] = []

    def line(self, line: str) -> Event | None:
        """Take one line; return an event where the line completes one that was not seen before."""
        if line.startswith("data:"):
            self._data.append(line[5:].removeprefix(" "))
            return None
        if line or not self._data:
            return None
        data, self._data = "\n".join(self._data), []
        event = msgspec.json.decode(data.encode(), type=Event)
        if event.seq <= self.last:
            return None
        self.last = event.seq
        return event

    def broken(self) -> None:
        """Forget the half of an event that a broken stream left."""
        self._data = []
