"""Chunks of an MCAP file: rosbags holds one in memory as a whole, so that none may be larger than there is room for."""

from __future__ import annotations

import struct
from pathlib import Path

from ...errors import RevisitError

MAGIC = b"\x89MCAP0\r\n"
CHUNK = 0x06
RECORD = struct.Struct("<BQ")
# First and last time, and the size before compression.
CHUNK_HEAD = struct.Struct("<QQQ")
# Writers cut chunks at a few megabytes; one message is at most 64 MiB.
MAX_CHUNK_BYTES = 128 << 20


def check_chunks(path: Path) -> None:
    """Refuse an MCAP file with a chunk that is too large; other files are none of its business."""
    size = path.stat().st_size
    with path.open("rb") as file:
        if file.read(len(MAGIC)) != MAGIC:
            return
        while True:
            head = file.read(RECORD.size)
            if len(head) < RECORD.size:
                return
            kind, length = RECORD.unpack(head)
            at = file.tell()
            if kind == CHUNK and length >= CHUNK_HEAD.size:
                inflated = CHUNK_HEAD.unpack(file.read(CHUNK_HEAD.size))[2]
                if max(length, inflated) > MAX_CHUNK_BYTES:
                    raise RevisitError(
                        f"{path}: a chunk in it has {max(length, inflated) >> 20} MiB; at most {MAX_CHUNK_BYTES >> 20} MiB are taken "
                        "(record it with smaller chunks)"
                    )
            # What claims to reach beyond the end is the reader's to refuse.
            if at + length > size:
                return
            file.seek(at + length)
