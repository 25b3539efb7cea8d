"""MCAP records, walked without any library: how many messages a topic has."""

from __future__ import annotations

import struct

import zstandard

MAGIC, SCHEMA, CHANNEL, MESSAGE, CHUNK, DATA_END = b"\x89MCAP0\r\n", 3, 4, 5, 6, 15


def counts(data: bytes) -> dict[tuple[str, str], int]:
    """Return the number of messages by topic and type."""
    assert data.startswith(MAGIC) and data.endswith(MAGIC)
    schemas: dict[int, str] = {}
    channels: dict[int, tuple[str, str]] = {}
    found: dict[tuple[str, str], int] = {}
    _walk(data[len(MAGIC) :], schemas, channels, found)
    return found


def _walk(data: bytes, schemas: dict[int, str], channels: dict[int, tuple[str, str]], found: dict[tuple[str, str], int]) -> None:
    at = 0
    while at < len(data):
        kind, size = data[at], struct.unpack_from("<Q", data, at + 1)[0]
        record, at = data[at + 9 : at + 9 + size], at + 9 + size
        if kind == SCHEMA:
            schemas[struct.unpack_from("<H", record)[0]] = _text(record, 2)
        elif kind == CHANNEL:
            id, schema = struct.unpack_from("<HH", record)
            channels[id] = (_text(record, 4), schemas[schema])
            found.setdefault(channels[id], 0)
        elif kind == MESSAGE:
            found[channels[struct.unpack_from("<H", record)[0]]] += 1
        elif kind == CHUNK:
            length = struct.unpack_from("<Q", record, 16)[0]
            compression = _text(record, 28)
            inside = record[32 + len(compression) + 8 :]
            assert compression in ("", "zstd")
            if compression:
                inside = zstandard.ZstdDecompressor().decompress(inside, max_output_size=length)
            _walk(inside, schemas, channels, found)
        elif kind == DATA_END:
            return


def _text(record: bytes, at: int) -> str:
    length = struct.unpack_from("<I", record, at)[0]
    return record[at + 4 : at + 4 + length].decode()
