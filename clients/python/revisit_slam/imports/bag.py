"""Bag: an open recording of ROS (MCAP, SQLite, or a ROS 1 bag), by its topics."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from ..errors import RevisitError
from ..left_out import LeftOut
from ..needed import needed
from .damage import told_of

SECOND_NS = 1_000_000_000
MAX_TOLD = 12


class Bag:
    """A recording that is open."""

    def __init__(self, file: Path, reader: Any, left_out: LeftOut) -> None:
        self.file, self.reader, self.left_out = file, reader, left_out

    def topics(self, *types: str) -> list[str]:
        """Return the topics of messages of these types."""
        return sorted({c.topic for c in self.reader.connections if c.msgtype in types})

    def raw(self, topic: str) -> Iterator[tuple[Any, int, bytes]]:
        """Yield connection, time of recording in nanoseconds and bytes of each message of a topic, in order of recording."""
        return self.reader.messages([connection for connection in self.reader.connections if connection.topic == topic])

    def messages(self, topic: str) -> Iterator[tuple[int, Any]]:
        """Yield the messages of a topic with their times in nanoseconds, in order of recording."""
        for connection, logged_ns, data in self.raw(topic):
            try:
                message = self.reader.deserialize(data, connection.msgtype)
            except Exception:  # noqa: BLE001 - it raises whatever a damaged message leads to
                name = f"{topic} at {logged_ns} ns"
                if name not in self.left_out:  # Topics are read more than once.
                    self.left_out.add(name, "a message that rosbags cannot read")
                continue
            header = getattr(message, "header", None)
            stamp_ns = header.stamp.sec * SECOND_NS + header.stamp.nanosec if header is not None else 0
            # A stamp that nobody set: the time of its recording.
            yield stamp_ns or logged_ns, message

    def first(self, topic: str) -> Any | None:
        """Return the first message of a topic."""
        return next((message for _, message in self.messages(topic)), None)

    def one(self, option: str, named: str | None, types: tuple[str, ...], skip: tuple[str, ...] = ()) -> str | None:
        """Return the topic that was named by an option, or the only one of these types; `skip`: words of unlikely ones."""
        there = self.topics(*types)
        if named is not None:
            if named not in there:
                raise RevisitError(f"{option} {named}: {self.file} has {', '.join(there) or 'none of its type'}")
            return named
        likely = [topic for topic in there if not any(word in topic for word in skip)] or there
        if len(likely) > 1:
            raise RevisitError(f"{self.file}: several topics; {option} names one: {', '.join(likely[:MAX_TOLD])}")
        return likely[0] if likely else None

    def told(self) -> str:
        """Return what there is, for a person."""
        topics = sorted({f"{c.topic} ({c.msgtype}, {c.msgcount})" for c in self.reader.connections})
        return ", ".join(topics[:MAX_TOLD]) or "nothing"


@contextmanager
def opened_bag(file: Path, pieces: list[Path], store: Any, left_out: LeftOut) -> Iterator[Bag]:
    """Open the pieces of a recording; they carry their messages' definitions, or have those of the store."""
    highlevel = needed("rosbags.highlevel", "rosbags")
    with told_of(file, "rosbags"), highlevel.AnyReader(pieces, default_typestore=store) as reader:
        yield Bag(file, reader, left_out)
