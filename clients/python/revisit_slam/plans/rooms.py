"""Signs of rooms: a name hangs at each door of its room, and in its middle where no door is drawn."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from .places import centre, doors_of, outward
from .plan import Plan, Point, Sign

# An area with more doors is no room with a sign at each, but a part of the building.
DOORS_MAX = 4


@dataclass(frozen=True)
class Room:
    """A room with the text of its sign; the outline ends where it begins."""

    text: str
    outline: Sequence[Point]


def add_rooms(plan: Plan, level: str, rooms: Iterable[Room], doors: Sequence[Point]) -> None:
    """Add the signs of a floor's rooms."""
    for room in rooms:
        own = doors_of(room.outline, doors)
        if len(own) > DOORS_MAX:
            plan.notes.append(f"{level}: {room.text} has {len(own)} doors and is taken for an area without a sign")
            continue
        if not own:
            plan.notes.append(f"{level}: {room.text} has no door; its sign is put in its middle")
            plan.signs.append(Sign(level, room.text, centre(room.outline)))
        for door in own:
            plan.signs.append(Sign(level, room.text, door, outward(door, room.outline)))
