"""A plan: the signs of a building's floors, each in its floor's frame."""

from __future__ import annotations

from dataclasses import dataclass, field

Point = tuple[float, float]


@dataclass(frozen=True)
class Sign:
    """A sign as a plan shows it; x and y in metres in the floor's frame, the normal out of the wall."""

    level: str
    text: str
    at: Point
    normal: Point | None = None


@dataclass
class Plan:
    """The signs of a file, with what its reader has to say about them."""

    source: str
    signs: list[Sign] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def levels(self) -> dict[str, list[Sign]]:
        """Return the signs by floor, in the file's order."""
        by_level: dict[str, list[Sign]] = {}
        for sign in self.signs:
            by_level.setdefault(sign.level, []).append(sign)
        return by_level

    def repeated(self) -> dict[str, int]:
        """Return the texts that stand in more than one place, with their number: none of them aligns anything alone."""
        counts: dict[str, int] = {}
        for sign in self.signs:
            counts[sign.text] = counts.get(sign.text, 0) + 1
        return {text: count for text, count in counts.items() if count > 1}
