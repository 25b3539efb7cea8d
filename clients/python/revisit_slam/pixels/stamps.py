"""Stamps: times as files and their names write them."""

from __future__ import annotations

import re
from decimal import Decimal, InvalidOperation

# Nanoseconds in the unit of a whole number, by its digits: seconds, milli-, micro- and nanoseconds since 1970.
UNITS = {10: 1_000_000_000, 13: 1_000_000, 16: 1_000, 19: 1}
UNIT_NAMES = dict(zip(UNITS.values(), ("seconds", "milliseconds", "microseconds", "nanoseconds")))


def nanoseconds(seconds: str) -> int:
    """Return decimal seconds in nanoseconds, to the last digit."""
    try:
        value = Decimal(seconds)
    except InvalidOperation as error:
        raise ValueError(seconds) from error
    if not value.is_finite() or abs(value) >= 10**12:
        raise ValueError(seconds)
    return int(value * 1_000_000_000)


def unit_ns(time: Decimal) -> int | None:
    """Return the nanoseconds of a time's unit, by its digits; fewer than those of milliseconds are seconds."""
    digits = len(str(abs(int(time))))
    return UNITS[10] if digits < 12 else UNITS.get(digits)


def named_time_ns(stem: str) -> int | None:
    """Return the time in nanoseconds that a name is; None where it is no time."""
    if re.fullmatch(r"\d{1,11}\.\d+|\d{1,9}", stem, re.ASCII):
        return nanoseconds(stem)
    unit = UNITS.get(len(stem)) if stem.isascii() and stem.isdigit() else None
    return None if unit is None else int(stem) * unit
