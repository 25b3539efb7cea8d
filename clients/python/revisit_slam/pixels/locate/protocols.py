"""Protocols: which part of the gallery a photograph is asked against."""

from __future__ import annotations

from dataclasses import dataclass

from .collection import Shot

# Photographs of a video are a second apart.
NEAR_S = 2

PROTOCOLS = {
    "A": "the whole gallery",
    "B": "without its video's photographs within 2 s",
    "C": "without its video",
}


@dataclass(frozen=True)
class Excluded:
    """What a question leaves out of the gallery."""

    keyframes: tuple[str, ...] = ()
    sessions: tuple[str, ...] = ()


def excluded(protocol: str, query: Shot, gallery: list[Shot]) -> Excluded:
    """Return what a protocol leaves out for one photograph."""
    own = [shot for shot in gallery if shot.session == query.session]
    if protocol == "A" or not own:
        return Excluded()
    if protocol == "C":
        return Excluded(sessions=(query.session,))
    near = [shot.frame.id for shot in own if abs(shot.frame.number - query.frame.number) <= NEAR_S]
    return Excluded(keyframes=tuple(near))
