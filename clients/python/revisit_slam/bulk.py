"""Bulk upload: keyframes from a generator, cut into requests that may be repeated."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import msgspec

from .call import Call, UnexpectedAnswer, segment
from .models import BulkItem, BulkLine
from .packing import packed

# The server takes 32 MiB a body; a smaller one is on disk sooner and cheaper to repeat.
MAX_BATCH_BYTES = 8 << 20
MAX_BATCH_ITEMS = 256

Item = BulkItem | Mapping[str, Any]


def batches(items: Iterable[Item]) -> Iterator[bytes]:
    """Return bodies of NDJSON, each bounded in bytes and items."""
    encoder, lines, size = msgspec.json.Encoder(), [], 0
    for item in items:
        line = encoder.encode(packed(item))
        if lines and (len(lines) >= MAX_BATCH_ITEMS or size + len(line) > MAX_BATCH_BYTES):
            yield b"\n".join(lines) + b"\n"
            lines, size = [], 0
        lines.append(line)
        size += len(line) + 1
    if lines:
        yield b"\n".join(lines) + b"\n"


def call_of(map: str, body: bytes) -> Call:
    """Return the request that stores one batch."""
    path = f"/v1/maps/{segment(map)}/keyframes"
    return Call("POST", path, body=body, answer=bytes, content_type="application/x-ndjson")


def lines_of(answer: bytes, before: int = 0) -> list[BulkLine]:
    """Return the outcome of each item; their numbers count on from the `before` items of earlier batches."""
    decoder = msgspec.json.Decoder(BulkLine)
    try:
        lines = [decoder.decode(line) for line in answer.splitlines() if line.strip()]
    except msgspec.DecodeError as error:
        raise UnexpectedAnswer(f"a bulk was not answered as the API document says: {error}") from error
    for line in lines:
        line.line += before
    return lines
