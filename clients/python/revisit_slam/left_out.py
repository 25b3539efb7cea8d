"""Left out: what a run does not play, told at its end: how many, which and why."""

from __future__ import annotations

SHOWN_MAX = 5


class LeftOut:
    """Things that are left out, by reason, in the order in which they were found."""

    def __init__(self) -> None:
        self._reasons: dict[str, list[str]] = {}

    def add(self, name: object, why: str) -> None:
        """Note one."""
        self._reasons.setdefault(why, []).append(str(name))

    @property
    def count(self) -> int:
        """How many there are."""
        return sum(map(len, self._reasons.values()))

    def told(self) -> list[str]:
        """Return a line for each reason."""
        return [f"left out {len(names)}: {why}: {_shown(names)}" for why, names in self._reasons.items()]


def _shown(names: list[str]) -> str:
    more = f" and {len(names) - SHOWN_MAX} more" if len(names) > SHOWN_MAX else ""
    return ", ".join(names[:SHOWN_MAX]) + more
