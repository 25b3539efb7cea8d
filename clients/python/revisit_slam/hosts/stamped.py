"""Stamped: messages of several topics that belong to one moment."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Iterator
from typing import Any

SECOND_NS = 1_000_000_000
# Messages of a topic that wait for the others.
MOST = 64


def stamp_ns(header: Any) -> int:
    """Return the time of a header."""
    return int(header.stamp.sec) * SECOND_NS + int(header.stamp.nanosec)


class Together:
    """Brings messages together whose times are near; of each topic the nearest counts, and older ones are forgotten."""

    def __init__(self, topics: tuple[str, ...], slop_s: float) -> None:
        self._slop_ns = round(slop_s * SECOND_NS)
        self._waiting: dict[str, OrderedDict[int, Any]] = {topic: OrderedDict() for topic in topics}

    def add(self, topic: str, at_ns: int, message: Any) -> Iterator[tuple[int, dict[str, Any]]]:
        """Add a message; yield each moment (of the first topic) that is complete now, with its messages."""
        waiting = self._waiting[topic]
        waiting[at_ns] = message
        while len(waiting) > MOST:
            waiting.popitem(last=False)
        first, *others = self._waiting
        for moment in sorted(self._waiting[first]):
            near = {other: self._nearest(other, moment) for other in others}
            if any(time is None for time in near.values()):
                continue
            found = {first: self._waiting[first][moment]}
            found |= {other: self._waiting[other][time] for other, time in near.items() if time is not None}
            self._forget(first, moment + 1)
            # The next moment may be as near to them.
            for other in others:
                self._forget(other, moment - self._slop_ns)
            yield moment, found

    def _nearest(self, topic: str, moment: int) -> int | None:
        times = [time for time in self._waiting[topic] if abs(time - moment) <= self._slop_ns]
        return min(times, key=lambda time: abs(time - moment), default=None)

    def _forget(self, topic: str, before_ns: int) -> None:
        waiting = self._waiting[topic]
        for time in [time for time in waiting if time < before_ns]:
            del waiting[time]
