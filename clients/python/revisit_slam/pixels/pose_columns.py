"""Columns of a pose: which number of a line is which, and in what unit, as the file's own names say."""

from __future__ import annotations

import re
from collections.abc import Sequence

# TUM's order, of files that name no columns.
TUM = ("t", "x", "y", "z", "qx", "qy", "qz", "qw")
METRES = {"m": 1.0, "cm": 1e-2, "mm": 1e-3}
NANOSECONDS = {"s": 10**9, "ms": 10**6, "us": 10**3, "ns": 1}
TIMES = {"t", "ts", "time", "stamp", "timestamp", "timestamps", "seconds"}
# Words that tell a position and a rotation from a velocity or a bias: `tx`, `p_RS_R_x`, `pose.position.x`.
PLACES = {"t", "p", "pos", "position", "pose", "trans", "translation"}
TURNS = {"q", "quat", "quaternion", "orientation", "rotation", "rot"}

Columns = dict[str, tuple[int, str]]


def columns_of(names: Sequence[str]) -> Columns:
    """Return the place and the unit of those of TUM's columns that are named, in any order; of two the first counts."""
    found: Columns = {}
    for place, name in enumerate(names):
        *words, last = re.findall("[a-z0-9]+", re.sub("[µμ]", "u", name.lower())) or [""]
        unit = last if words and last in METRES | NANOSECONDS else ""
        *words, last = words if unit else (*words, last)
        axis, before = last[-1:], {*words, last[:-1]}
        if last in TIMES:
            found.setdefault("t", (place, unit))
        elif f"q{axis}" in TUM and len(last) < 3 and before & TURNS:
            found.setdefault(f"q{axis}", (place, ""))
        elif axis in TUM[1:4] and len(last) < 3 and (before & PLACES or before == {""}):
            found.setdefault(axis, (place, unit))
    return found
