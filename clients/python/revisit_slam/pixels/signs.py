"""Signs: what two readings of a text agree on, and how sure it is."""

from __future__ import annotations

import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from .overlap import Overlap
from .pinhole import Pinhole
from .reader import Line

Boxed = TypeVar("Boxed", Line, "Sign")

# One class for all: a photograph alone does not tell a door plate from a poster.
SIGN_CLASS = "sign"
# A number that stands with a word is part of a name ("HUB 04", "Gate 7"). Names hang on several floors, or point to
# other places: they are sent as a class of their own, which a map takes for anchors only where it is asked to.
NAME_CLASS = "name"
# Readings below this are left out: they are seldom text.
MIN_CONFIDENCE = 0.5
# The server takes a reading below its `reading_min_confidence` for unsure until it is read alike again.
DISAGREED_CONFIDENCE = 0.6
CUT_CONFIDENCE = 0.5
# A single letter or digit is what a reader makes of lamps and handles; a real one is read without any doubt.
SINGLE_MIN_CONFIDENCE = 0.95
# A text nearer to the picture's edge than this share of its height may be cut.
CUT_SHARE = 0.25
MIN_WORD_LETTERS = 2
MAX_LETTERS_RATIO = 2.0


@dataclass(frozen=True)
class Sign:
    """A text in a photograph, with its confidence and the evidence for it."""

    box: tuple[float, float, float, float]
    text: str
    confidence: float
    evidence: str
    other_reading: str = ""
    kind: str = SIGN_CLASS
    letters_px: float = 1.0
    """Height of its letters; that of its first sighting where it was tracked from there."""


def plain(text: str) -> str:
    """Return what two readings are compared by: letters, digits and dots, in one case and width."""
    folded = unicodedata.normalize("NFKC", text).casefold()
    return "".join(letter for letter in folded if letter.isalnum() or letter in ".-/")


@dataclass(frozen=True)
class Neighbour:
    """An earlier photograph that overlaps: its readings, the signs made of them, and the overlap."""

    lines: Sequence[Line]
    signs: Sequence[Sign]
    found: Overlap


def judge(lines: Sequence[Line], camera: Pinhole, neighbours: Sequence[Neighbour]) -> list[Sign]:
    """Return the signs of a photograph."""
    signs = []
    for line in lines:
        sign = _agree(line, neighbours)
        if sign is None or not plain(sign.text):
            continue
        if len(plain(sign.text)) == 1 and sign.confidence < SINGLE_MIN_CONFIDENCE:
            continue
        if _cut(line.box, camera):
            sign = replace(sign, confidence=min(sign.confidence, CUT_CONFIDENCE), evidence="cut by the edge")
        signs.append(replace(sign, letters_px=_letters_px(sign.box, neighbours)))
    return [_named(sign, signs) for sign in signs]


def _named(sign: Sign, signs: Sequence[Sign]) -> Sign:
    """Join a bare number with the word that it stands with, if there is one."""
    if not plain(sign.text).isdigit():
        return sign
    for word in signs:
        if sum(letter.isalpha() for letter in word.text) >= MIN_WORD_LETTERS and _together(sign.box, word.box):
            return replace(
                sign, text=f"{word.text} {sign.text}", kind=NAME_CLASS, confidence=min(sign.confidence, word.confidence)
            )
    return sign


def _together(number: tuple[float, float, float, float], word: tuple[float, float, float, float]) -> bool:
    """Whether a number stands right below, above or beside a word of letters like its own."""
    letters = (number[3] - number[1], word[3] - word[1])
    if max(letters) > MAX_LETTERS_RATIO * min(letters):
        return False
    gap = 0.5 * max(letters)
    across = min(number[2], word[2]) - max(number[0], word[0])
    down = min(number[3], word[3]) - max(number[1], word[1])
    stacked = across >= 0.5 * min(number[2] - number[0], word[2] - word[0]) and -gap <= down
    beside = down >= 0.5 * min(letters) and -2 * gap <= across
    return stacked or beside


def _letters_px(box: tuple[float, float, float, float], neighbours: Sequence[Neighbour]) -> float:
    """Return the height of a sign's letters, that of an earlier sighting if there is one.

    One sign's box differs by a fifth between photographs, and so would its place.
    """
    for neighbour in neighbours:
        before = _same_place(box, neighbour.signs, neighbour.found)
        if before is not None:
            return before.letters_px
    # A line that runs downwards has its letters' height across.
    return max(min(box[2] - box[0], box[3] - box[1]), 1.0)


def _agree(line: Line, neighbours: Sequence[Neighbour]) -> Sign | None:
    first, second = plain(line.text), plain(line.second_text)
    if first == second:
        # As sure as the weaker of the two.
        confidence = min(line.confidence, line.second_confidence)
        return Sign(line.box, line.text, confidence, "two readings agree") if confidence >= MIN_CONFIDENCE else None
    text, confidence, other = (
        (line.text, line.confidence, line.second_text)
        if line.confidence >= line.second_confidence
        else (line.second_text, line.second_confidence, line.text)
    )
    if confidence < MIN_CONFIDENCE:
        return None
    for neighbour in neighbours:
        before = _same_place(line.box, neighbour.lines, neighbour.found)
        for candidate, sure in ((line.text, line.confidence), (line.second_text, line.second_confidence)):
            if before is not None and plain(candidate) and plain(candidate) == plain(before.text) == plain(before.second_text):
                sure = min(sure, before.confidence, before.second_confidence)
                return Sign(line.box, candidate, sure, "a neighbouring photograph agrees", other)
    return Sign(line.box, text, min(confidence, DISAGREED_CONFIDENCE), "two readings disagree", other)


def _same_place(box: tuple[float, float, float, float], others: Sequence[Boxed], found: Overlap) -> Boxed | None:
    """Return the line or sign of an earlier photograph in which a box's centre falls."""
    if found.homography is None:
        return None
    x0, y0, x1, y1 = box
    point = found.homography @ np.array([(x0 + x1) / 2, (y0 + y1) / 2, 1.0])
    if point[2] <= 1e-9:
        return None
    x, y = point[0] / point[2], point[1] / point[2]
    for other in others:
        left, top, right, bottom = other.box
        margin = bottom - top
        if left - margin / 2 <= x <= right + margin / 2 and top - margin / 2 <= y <= bottom + margin / 2:
            return other
    return None


def _cut(box: tuple[float, float, float, float], camera: Pinhole) -> bool:
    x0, y0, x1, y1 = box
    margin = CUT_SHARE * min(y1 - y0, x1 - x0)
    return x0 < margin or y0 < margin or x1 > camera.width - margin or y1 > camera.height - margin
