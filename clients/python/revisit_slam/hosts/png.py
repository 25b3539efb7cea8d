"""PNG: a small picture as a file, without an imaging library."""

from __future__ import annotations

import struct
import zlib

import numpy as np

SIGNATURE = b"\x89PNG\r\n\x1a\n"
GREY, RGB = 0, 2


def png(picture: np.ndarray) -> bytes:
    """Return a picture of 8 bits (rows x columns, or with three channels: red, green, blue) as a PNG file."""
    rows, columns = picture.shape[:2]
    colour = RGB if picture.ndim == 3 else GREY
    # Before each row stands its filter: none.
    lines = np.hstack((np.zeros((rows, 1), np.uint8), np.ascontiguousarray(picture, np.uint8).reshape(rows, -1)))
    header = struct.pack(">IIBBBBB", columns, rows, 8, colour, 0, 0, 0)
    return SIGNATURE + _chunk(b"IHDR", header) + _chunk(b"IDAT", zlib.compress(lines.tobytes(), 1)) + _chunk(b"IEND", b"")


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
