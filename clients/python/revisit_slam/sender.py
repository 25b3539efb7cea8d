"""Keyframe sender: takes keyframes without ever blocking, and sends them in the background."""

from __future__ import annotations

import logging
import tempfile
import threading
import time
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any

import msgspec

from . import bulk
from .client import Client
from .models import BulkLine, Keyframe
from .packing import packed
from .problems import ProblemError, RevisitError
from .spill import Spill

# 30 keyframes a second for the 30 s of an outage, with a fifth to spare; what is more goes to disk.
QUEUE_KEYFRAMES = 1080
QUEUE_BYTES = 256 << 20
SPILL_BYTES = 1 << 30
BATCH = 64
LONGEST_WAIT_S = 2.0


@dataclass(frozen=True)
class SenderStats:
    """Figures of a sender: keyframes waiting in memory and on disk, sent, refused, dropped; seconds behind."""

    queued: int
    spilled: int
    sent: int
    refused: int
    dropped: int
    lag_s: float
    unreachable: bool


class KeyframeSender:
    """A bounded queue before a server, emptied by a thread.

    `put` returns at once, whatever the server does. Keyframes wait in memory (1,080 of them: 36 s at 30 a second, or
    256 MiB), then in a file (`spill`, 1 GiB), both in order; beyond that they are dropped and counted. A file that
    `close` could not empty is sent first by the next sender with the same `spill`.

    `on_line` is called in the sender's thread with the outcome of each keyframe.
    """

    def __init__(
        self,
        client: Client,
        map: str,
        *,
        spill: Path | None = None,
        queue_keyframes: int = QUEUE_KEYFRAMES,
        spill_bytes: int = SPILL_BYTES,
        on_line: Callable[[BulkLine], None] | None = None,
    ) -> None:
        self._client, self._map, self._on_line = client, map, on_line
        self._folder = tempfile.TemporaryDirectory(prefix="revisit-spill-") if spill is None else None
        self._spill = Spill(spill or Path(self._folder.name) / "spill.ndjson", spill_bytes)  # type: ignore[union-attr]
        self._memory: deque[tuple[float, bytes]] = deque()
        # Newer than what is on disk: appended by `put`, moved by the spilling thread, so that `put` writes no file.
        self._incoming: deque[tuple[float, bytes]] = deque()
        self._flying: list[tuple[float, bytes]] = []
        self._bytes = 0
        self._queue_keyframes = queue_keyframes
        self._sent = self._refused = self._dropped = 0
        self._unreachable = False
        self._oldest_spilled: float | None = time.monotonic() if self._spill.count else None
        self._closing = self._abandon = False
        # A line on its way between the queues, so that none overtakes another while no lock is held.
        self._moving: list[bytes] = []
        self._loading = False
        self._disk = threading.Lock()
        self._changed = threading.Condition()
        self._threads = [
            threading.Thread(target=self._send, name="revisit-sender", daemon=True),
            threading.Thread(target=self._move, name="revisit-spiller", daemon=True),
        ]
        for thread in self._threads:
            thread.start()

    def put(self, id: str, keyframe: Keyframe | Mapping[str, Any]) -> bool:
        """Take a keyframe; False where it had to be dropped. The keyframe may be changed afterwards."""
        line = msgspec.json.encode({"id": id, **packed(keyframe)})
        with self._changed:
            if self._closing:
                raise RevisitError("the sender is closed")
            # Twice the queue: the spilling thread may be slower than a burst.
            if len(self._incoming) >= 2 * self._queue_keyframes or self._bytes + len(line) > QUEUE_BYTES:
                self._dropped += 1
                return False
            self._incoming.append((time.monotonic(), line))
            self._bytes += len(line)
            self._changed.notify_all()
        return True

    def stats(self) -> SenderStats:
        """Return the figures of this moment."""
        with self._changed:
            queued = len(self._memory) + len(self._incoming) + len(self._flying)
            oldest = [line[0] for line in (*self._flying[:1], *list(self._memory)[:1], *list(self._incoming)[:1])]
            if self._spill.count and self._oldest_spilled is not None:
                oldest.append(self._oldest_spilled)
            lag_s = time.monotonic() - min(oldest) if oldest else 0.0
            return SenderStats(queued, self._spill.count, self._sent, self._refused, self._dropped, lag_s, self._unreachable)

    def flush(self, timeout_s: float) -> bool:
        """Wait until everything was sent; whether it was, within the time."""
        with self._changed:
            return self._changed.wait_for(self._empty, timeout_s)

    def close(self, timeout_s: float = 30.0) -> int:
        """Send what is left for at most `timeout_s`; return how many keyframes were not sent.

        With a `spill` of one's own these stay on disk for the next sender.
        """
        with self._changed:
            self._closing = True
            self._changed.notify_all()
            self._changed.wait_for(self._empty, timeout_s)
            self._abandon = True
            self._changed.notify_all()
        for thread in self._threads:
            # A request in flight may last; the threads are daemons.
            thread.join(1.0)
        with self._changed:
            older = [line for _, line in (*self._flying, *self._memory)]
            for _, line in self._incoming:
                if not self._spill.append(line):
                    self._dropped += 1
            self._spill.put_back(older)
            left = self._spill.count
            self._spill.close()
        if self._folder is not None:
            self._folder.cleanup()
        return left

    def __enter__(self) -> KeyframeSender:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def _empty(self) -> bool:
        return not (self._memory or self._incoming or self._flying or self._moving or self._loading or self._spill.count)

    def _move(self) -> None:
        """Move keyframes from `put` to memory, or to disk where memory is full or older ones are on disk."""
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._incoming or self._abandon)
                if self._abandon:
                    return
                at, line = self._incoming.popleft()
                if self._spill.count == 0 and not self._loading and len(self._memory) < self._queue_keyframes:
                    self._memory.append((at, line))
                    self._changed.notify_all()
                    continue
                self._bytes -= len(line)
                self._moving = [line]
            # Without the lock that `put` takes: a slow disk must not hold the caller up.
            with self._disk:
                kept = self._spill.append(line)
            with self._changed:
                self._moving = []
                if not kept:
                    self._dropped += 1
                elif self._oldest_spilled is None:
                    self._oldest_spilled = at
                self._changed.notify_all()

    def _send(self) -> None:
        attempt = 0
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._memory or self._spill.count or self._abandon)
                if self._abandon:
                    return
                self._loading = not self._memory
            if self._loading:
                with self._disk:
                    taken = self._spill.take(BATCH)
                with self._changed:
                    # Their own times are not on disk: they count as old as the oldest of them.
                    at = self._oldest_spilled or time.monotonic()
                    self._memory.extend((at, line) for line in taken)
                    self._bytes += sum(map(len, taken))
                    self._loading = False
                    if self._spill.count == 0:
                        self._oldest_spilled = None
            with self._changed:
                size = 0
                while self._memory and len(self._flying) < BATCH and size < bulk.MAX_BATCH_BYTES:
                    self._flying.append(self._memory.popleft())
                    size += len(self._flying[-1][1])
            if not self._flying:
                continue
            wait_s = self._post(attempt)
            attempt = 0 if wait_s is None else attempt + 1
            if wait_s is not None:
                with self._changed:
                    self._changed.wait_for(lambda: self._abandon, wait_s)
                    if self._abandon:
                        return
                    # In front of all others again, in order.
                    self._memory.extendleft(reversed(self._flying))
                    self._flying = []

    def _post(self, attempt: int) -> float | None:
        """Send the batch in flight; return how long to wait before it is tried again, None where it is done."""
        body = b"\n".join(line for _, line in self._flying) + b"\n"
        try:
            lines = bulk.lines_of(self._client.once(bulk.call_of(self._map, body)))
        except RevisitError as error:
            refusal = isinstance(error, ProblemError) and error.status < 500 and error.status not in (408, 429)
            if not refusal:
                self._unreachable = True
                asked = error.retry_after_s if isinstance(error, ProblemError) else None
                return asked if asked is not None else min(0.1 * 2 ** min(attempt, 10), LONGEST_WAIT_S)
            # The whole body is refused, such as by a map that is not there: so is each keyframe of it.
            lines = [
                BulkLine(line=number, status=error.status, problem=error.problem)
                for number in range(1, len(self._flying) + 1)
            ]
        retried = {line.line for line in lines if line.status in (429, 500, 503, 507)}
        with self._changed:
            self._unreachable = False
            again = [item for number, item in enumerate(self._flying, 1) if number in retried]
            for line in lines:
                if line.line in retried:
                    continue
                if line.status < 300:
                    self._sent += 1
                else:
                    self._refused += 1
            self._bytes -= sum(len(line) for number, (_, line) in enumerate(self._flying, 1) if number not in retried)
            self._flying = again
            self._changed.notify_all()
        for line in lines:
            if self._on_line is not None and line.line not in retried:
                try:
                    self._on_line(line)
                except Exception:  # noqa: BLE001 - the caller's fault must not end the sending
                    logging.getLogger(__name__).exception("on_line failed")
        return min(0.1 * 2 ** min(attempt, 10), LONGEST_WAIT_S) if again else None
