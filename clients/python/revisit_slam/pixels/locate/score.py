"""Score: how many photographs were located, how many of these on a wrong floor, and where the first place is."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from .asking import LOCATED, Asked


@dataclass
class Score:
    """Figures of one protocol. `located` and `wrong` are counts, `top1` the share whose first place is on the right floor."""

    queries: int = 0
    located: int = 0
    wrong: int = 0
    top1: float = 0.0

    @staticmethod
    def of(protocol: str, asked: Iterable[Asked]) -> Score:
        """Return the figures of a protocol."""
        score, first = Score(), 0
        for one in asked:
            answer = one.answers[protocol]
            is_right = bool(answer.places) and answer.places[0].map == one.shot.map
            is_located = answer.verdict == LOCATED
            score.queries += 1
            score.located += is_located
            score.wrong += is_located and not is_right
            first += is_right
        score.top1 = round(first / score.queries, 4) if score.queries else 0.0
        return score
