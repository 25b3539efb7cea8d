"""Columns of a pose: which number of a line is which, and in what unit, as the file's own names say."""

from __future__ import annotations

import re
from collections.abc import Sequence

# TUM's order, of files that name no columns.
TUM = ("t", "x", "y", "z", "qx", "qy", "qz", "qw")
METRES = {"": 1.0, "m": 1.0, "cm": 1e-2, "mm": 1e-3}
NANOSECONDS = {"s": 10**9, "sec": 10**9, "ms": 10**6, "us": 10**3, "ns": 1}
UNIT = re.compile(rf"(.+?)(?:_({'|'.join(filter(None, METRES | NANOSECONDS))}))?")
# A position, not a velocity or a bias: `x`, `tx`, `p_RS_R_x`, `pose.position.x`. Then its quaternion, and its time.
PLACES = re.compile(r"(?:[tp]?_?|(?:.*_)?(?:p|t|pos|position|pose|trans|translation)_(?:.*_)?)([xyz])")
TURNS = re.compile(r"(?:(?:.*_)?q_?|(?:.*_)?(?:q|quat|quaternion|orientation|rotation|rot)_(?:.*_)?)([xyzw])")
TIMES = re.compile(r"t|ts|(?:.*_)?(?:time|stamp|time_?stamps?|seconds|nanoseconds)")

Columns = dict[str, tuple[int, str]]


def columns_of(names: Sequence[str]) -> Columns:
    """Return the place and the unit of those of TUM's columns that are named, in any order; of two the first counts."""
    found: Columns = {}
    for place, name in enumerate(names):
        plain = re.sub(r"[^a-z0-9]+", "_", re.sub("[µμ]", "u", name.lower())).strip("_")
        base, unit = match.groups("") if (match := UNIT.fullmatch(plain)) else ("", "")
        if turned := TURNS.fullmatch(base):
            found.setdefault(f"q{turned[1]}", (place, ""))
        elif placed := PLACES.fullmatch(base):
            found.setdefault(placed[1], (place, unit))
        # A time in two columns, of seconds and of nanoseconds, is not one of these.
        elif TIMES.fullmatch(base) and not any(re.search("n(ano)?secs?$", other.lower()) for other in names):
            found.setdefault("t", (place, unit))
    return found
