"""Opened: a file of another system, ready to be read from its first keyframe to its last."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from ..arguments import MAX_SESSION
from ..pixels.ids import plain_id
from .damage import Account
from .observation import Observation


@dataclass(frozen=True)
class Wanted:
    """What a person asked for: a name for the sessions, a length of the unit, a topic, and a database beside a model."""

    session: str | None = None
    metres_per_unit: float | None = None
    topic: str | None = None
    database: Path | None = None

    def name(self, path: Path) -> str:
        """Return what sessions are called: as was asked, or after the file."""
        return self.session or plain_id(path.resolve().stem or "map", MAX_SESSION)


@dataclass(frozen=True)
class Opened:
    """A map of another system."""

    system: str
    """As a person calls it."""
    metric: bool
    keyframes: Callable[[], Iterator[Observation]]
    """Reads them in order of time; an observation names only earlier ones."""
    account: Account
    """Reading adds to it."""
