"""Links of RTAB-Map's graph: which make two nodes covisible, and which are loops that it closed."""

from __future__ import annotations

from collections import Counter

NEIGHBOUR, GLOBAL_CLOSURE, LOCAL_SPACE_CLOSURE, LOCAL_TIME_CLOSURE, USER_CLOSURE, NEIGHBOUR_MERGED = 0, 1, 2, 3, 4, 6
# Proximity links are of places that odometry knows to be near: no loop was detected.
COVISIBLE = {NEIGHBOUR, LOCAL_SPACE_CLOSURE, LOCAL_TIME_CLOSURE, NEIGHBOUR_MERGED}
LOOPS = {GLOBAL_CLOSURE, USER_CLOSURE}


def shared_words(one: Counter[int] | None, other: Counter[int] | None) -> int:
    """Return how many words two nodes have in common."""
    return len((one or Counter()).keys() & (other or Counter()).keys())
