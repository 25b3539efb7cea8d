"""Stamps: the time that a photograph's file is named by."""

from __future__ import annotations

import re

from .trajectory import nanoseconds

# Nanoseconds in the unit of a whole number, by its digits: seconds, milli-, micro- and nanoseconds since 1970.
UNITS = {10: 1_000_000_000, 13: 1_000_000, 16: 1_000, 19: 1}


def named_time_ns(stem: str) -> int | None:
    """Return the time in nanoseconds that a name is; None where it is no time."""
    if re.fullmatch(r"\d{1,11}\.\d+|\d{1,9}", stem, re.ASCII):
        return nanoseconds(stem)
    unit = UNITS.get(len(stem)) if stem.isascii() and stem.isdigit() else None
    return None if unit is None else int(stem) * unit
