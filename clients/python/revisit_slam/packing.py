"""Packed columns: long lists of numbers as base64 of little-endian values.

The server makes the same facts of both forms, so that a retry in the other form is a retry. A list stays a list where
its numbers would not come back exactly, or where it is wrong: the server says what is wrong with a list, item by item.
"""

from __future__ import annotations

import base64
import math
import struct
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import msgspec

# A shorter list gains nothing.
MIN_ITEMS = 32


class Column(NamedTuple):
    """A list of a keyframe, its packed name, the type of its numbers (as `struct` calls it), and how many an item has."""

    object: str | None
    name: str
    packed: str
    type: str
    row: int | None = None


COLUMNS = [
    Column("bow", "words", "words_u32", "I"),
    Column("bow", "weights", "weights_f64", "d"),
    Column("features", "keypoints", "keypoints_f32", "f", 4),
    Column("features", "map_points", "map_points_i64", "q"),
    Column("map_points", "ids", "ids_i64", "q"),
    Column("map_points", "positions", "positions_f64", "d", 3),
    Column(None, "observes", "observes_i64", "q"),
]
# A keypoint may leave out its octave and its angle, which a packed one cannot.
LEFT_OUT = (0.0, 0.0, 0.0, math.nan)


def packed(keyframe: msgspec.Struct | Mapping[str, Any]) -> dict[str, Any]:
    """Return a keyframe's body with its long columns packed. Columns may be lists or arrays of numpy."""
    body = msgspec.to_builtins(keyframe) if isinstance(keyframe, msgspec.Struct) else dict(keyframe)
    for column in COLUMNS:
        holder = body if column.object is None else body.get(column.object)
        if not isinstance(holder, Mapping) or column.name not in holder:
            continue
        values = holder[column.name]
        values = values.tolist() if hasattr(values, "tolist") else values
        data = _bytes(column, values)
        holder = {name: value for name, value in holder.items() if name != column.name}
        holder |= {column.name: values} if data is None else {column.packed: base64.b64encode(data).decode()}
        if column.object is None:
            body = holder
        else:
            body[column.object] = holder
    return body


def _bytes(column: Column, values: Any) -> bytes | None:
    """Return the numbers of a column as bytes, if that keeps each of them."""
    if not isinstance(values, Sequence) or isinstance(values, str) or len(values) < MIN_ITEMS:
        return None
    try:
        flat = values if column.row is None else [number for row in values for number in _whole(column, row)]
        data = struct.pack(f"<{len(flat)}{column.type}", *flat)
    except (struct.error, TypeError, ValueError, OverflowError):
        return None
    if column.type == "f":
        back = struct.unpack(f"<{len(flat)}f", data)
        if any(a != b and not (math.isnan(a) and math.isnan(b)) for a, b in zip(back, flat, strict=True)):
            return None
    return data


def _whole(column: Column, row: Any) -> Sequence[float]:
    """Return an item with all of its numbers."""
    least = 2 if column.name == "keypoints" else column.row
    if least is None or column.row is None or not least <= len(row) <= column.row:
        raise ValueError("an item of another length")
    return [*row, *LEFT_OUT[len(row) : column.row]]
