"""A plan: the signs of a building's floors, each in its floor's frame."""

from __future__ import annotations

import contextlib
import json
from dataclasses import dataclass, field
from typing import Any

from ..left_out import LeftOut

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
    """The signs of a file, with what its reader has to say about them: what it assumed, notes, and what it left out."""

    source: str
    signs: list[Sign] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    assumed: list[str] = field(default_factory=list)
    left_out: LeftOut = field(default_factory=LeftOut)

    def levels(self) -> dict[str, list[Sign]]:
        """Return the signs by floor, in the file's order."""
        by_level: dict[str, list[Sign]] = {}
        for sign in self.signs:
            by_level.setdefault(sign.level, []).append(sign)
        return by_level


def words(value: Any, language: str = "") -> str:
    """Return what a property says: a text, a number, or of texts by language the one that is asked for, else the first."""
    if texts := texts_by_language(value):
        near = [text for tag, text in texts.items() if tag.lower().split("-")[0] == language.lower().split("-")[0]]
        return texts.get(language) or [*near, *texts.values()][0]
    if isinstance(value, float) and value.is_integer():
        value = int(value)
    is_said = isinstance(value, (str, int, float)) and not isinstance(value, bool) and not str(value).startswith("{")
    return " ".join(str(value).split()) if is_said else ""


def texts_by_language(value: Any) -> dict[str, str]:
    """Return the texts of an object like `{"en": "Library"}`, which ogr2ogr writes as a text."""
    if isinstance(value, str) and value.startswith("{"):
        with contextlib.suppress(ValueError):
            value = json.loads(value)
    listed = value.items() if isinstance(value, dict) else ()
    return {tag: " ".join(text.split()) for tag, text in listed if isinstance(text, str) and text.strip()}
