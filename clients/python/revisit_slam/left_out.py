"""Left out: what a run does not play, told at its end: how many, which and why."""

from __future__ import annotations

import struct
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager

from .errors import RevisitError

SHOWN_MAX = 5
# What a file of another form leads its reader to.
WRONG = (RevisitError, ValueError, TypeError, AttributeError, LookupError, ArithmeticError, struct.error)


class Unreadable(RevisitError):
    """One thing that cannot be read: its name, and why."""

    def __init__(self, name: object, why: str) -> None:
        super().__init__(f"{name}: {why}")
        self.name, self.why = name, why


class LeftOut:
    """Things that are left out, by reason, in the order in which they were found."""

    def __init__(self) -> None:
        self._reasons: dict[str, Counter[str]] = {}

    def __contains__(self, name: object) -> bool:
        return any(str(name) in names for names in self._reasons.values())

    def add(self, name: object, why: str, count: int = 1) -> None:
        """Note one, or what has so many."""
        self._reasons.setdefault(why, Counter())[str(name)] += count

    @contextmanager
    def part(self, more: str = "") -> Iterator[None]:
        """Do something with one thing, which is left out where it cannot be read."""
        try:
            yield
        except Unreadable as error:
            self.add(error.name, error.why + more)

    @contextmanager
    def unless(self, name: object, why: str) -> Iterator[None]:
        """Take one thing apart, which is left out for this reason where it is not what it should be."""
        try:
            yield
        except WRONG:
            self.add(name, why)

    def add_all(self, other: LeftOut, where: str) -> None:
        """Note what was left out of something that this has."""
        for why, names in other._reasons.items():
            for name, count in names.items():
                self.add(f"{where}, {name}", why, count)

    @property
    def count(self) -> int:
        """How many there are."""
        return sum(names.total() for names in self._reasons.values())

    def told(self) -> list[str]:
        """Return a line for each reason."""
        return [f"left out {names.total()}: {why}: {shown(list(names))}" for why, names in self._reasons.items()]


def shown(names: list[str], most: int = SHOWN_MAX) -> str:
    """Return the first of many names."""
    return ", ".join(names[:most]) + (f" and {len(names) - most} more" if len(names) > most else "")
