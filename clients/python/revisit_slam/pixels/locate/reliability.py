"""Reliability: whether the confidence keeps what it says."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from .asking import Asked

# Of the answers at or above each, at least this share should be right.
LEVELS = (0.5, 0.8, 0.9, 0.95, 0.99)


@dataclass(frozen=True)
class Level:
    """The answers whose confidence is at least `confidence`: how many there are, and how many name the right floor."""

    confidence: float
    answers: int
    right: int


def reliability(protocols: Sequence[str], asked: Iterable[Asked]) -> list[Level]:
    """Return the levels over the answers of some protocols together."""
    answered = [(one.answers[protocol], one.shot.map) for one in asked for protocol in protocols]
    levels = []
    for level in LEVELS:
        above = [(answer, map) for answer, map in answered if answer.places and answer.confidence >= level]
        right = sum(answer.places[0].map == map for answer, map in above)
        levels.append(Level(level, len(above), right))
    return levels
