"""A relay to PostgreSQL that counts round trips: how often a client waits for an answer before it sends more."""

import collections

from relay import Relay

SSL_REQUEST = (80877103).to_bytes(4, "big")
# A client that has sent one of these waits until PostgreSQL is ready for the next: a simple query, or the end of an extended one.
WAITS = b"QS"
# What is prepared on a connection tells what it is for; each of a server's pools prepares one of these before it is measured.
KINDS = {b"insert into nodes": "leases", b"for key share": "writer"}


class Trips(Relay):
    """Relays a server's connections, and counts their round trips by what they are for: `writer`, `leases`, or `readers`.

    `pings` are those of `writer` and `readers` that ask nothing: whether the connection is still there.
    """

    def __init__(self, port):
        self.taps = []
        super().__init__(port)

    def carry(self, pair, source, sink, gate):
        if gate is self.requests:
            source = Tap(source)
            self.taps.append(source)
        super().carry(pair, source, sink, gate)

    def counted(self):
        counts = collections.Counter()
        for tap in list(self.taps):
            counts[tap.kind] += tap.trips
            counts["pings"] += tap.pings if tap.kind != "leases" else 0
        return counts


class Tap:
    """Reads along what a client sends on one connection, in PostgreSQL's protocol 3.0."""

    def __init__(self, source):
        self.source, self.pending, self.is_started = source, b"", False
        self.kind, self.trips, self.pings, self.asks = "readers", 0, 0, False

    def recv(self, size):
        chunk = self.source.recv(size)
        self.pending += chunk
        at = 0
        while message := self.message(at):
            self.read(message)
            at += len(message)
        self.pending = self.pending[at:]
        return chunk

    def message(self, at):
        """Returns the message that begins there, if all of it has come. Those before the start have no type."""
        before = at + (1 if self.is_started else 0)
        if len(self.pending) < before + 4:
            return None
        end = before + int.from_bytes(self.pending[before:before + 4], "big")
        return self.pending[at:end] if len(self.pending) >= end else None

    def read(self, message):
        if not self.is_started:
            self.is_started = message[4:8] != SSL_REQUEST
            return
        if message[0] in WAITS:
            self.trips += 1
            self.pings += message[:1] == b"S" and not self.asks
        self.asks = message[0] not in WAITS
        if message[:1] == b"P":
            self.kind = next((kind for text, kind in KINDS.items() if text in message), self.kind)
