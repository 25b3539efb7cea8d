"""Turn: from a picture as it is stored to what a person sees, by the way in which the camera was held (EXIF's orientation)."""

from __future__ import annotations

import itertools
from typing import NamedTuple

import numpy as np


class Turn(NamedTuple):
    """A transposition, then a reversal of the rows and of the columns; without any, what is stored is what is seen."""

    transposed: bool = False
    rows: bool = False
    columns: bool = False

    @staticmethod
    def between(stored: np.ndarray, seen: np.ndarray) -> Turn:
        """Return the turn that makes one picture of the other."""
        turns = itertools.starmap(Turn, itertools.product((False, True), repeat=3))
        return next((turn for turn in turns if np.array_equal(turn.seen(stored), seen)), Turn())

    def seen(self, stored: np.ndarray) -> np.ndarray:
        """Return a picture, or a part of it, as a person sees it."""
        image = stored.swapaxes(0, 1) if self.transposed else stored
        return np.ascontiguousarray(image[:: -1 if self.rows else 1, :: -1 if self.columns else 1])

    def stored_from_seen(self, width: int, height: int) -> np.ndarray:
        """Return where pixels that are seen are stored (3 x 3), in a picture that is seen in this size."""
        x = (-1, 0, width - 1) if self.columns else (1, 0, 0)
        y = (0, -1, height - 1) if self.rows else (0, 1, 0)
        return np.array([y, x, (0, 0, 1)] if self.transposed else [x, y, (0, 0, 1)], float)


def moved(box: tuple[float, ...], matrix: np.ndarray) -> tuple[float, float, float, float]:
    """Return a box where a turn's matrix puts it."""
    (x0, x1), (y0, y1) = np.sort(matrix[:2, :2] @ np.reshape(box, (2, 2)).T + matrix[:2, 2:])
    return tuple(round(float(side), 1) for side in (x0, y0, x1, y1))  # type: ignore[return-value]
