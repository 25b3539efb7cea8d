"""Inbox: what a host's callback leaves behind at once, for a thread to work on."""

from __future__ import annotations

import logging
import threading
from collections import deque
from collections.abc import Callable
from typing import Any


class Inbox:
    """A bounded queue and the thread that empties it, in order.

    `put` returns at once, whatever the thread does. Where the queue is full the oldest item is dropped, and counted.
    """

    def __init__(self, name: str, most: int) -> None:
        self._most = most
        self._waiting: deque[Callable[[], Any]] = deque()
        self._busy = self._closing = False
        self.dropped = self.failed = 0
        self._changed = threading.Condition()
        self._thread = threading.Thread(target=self._run, name=name, daemon=True)
        self._thread.start()

    def put(self, work: Callable[[], Any]) -> None:
        """Leave work to the thread."""
        with self._changed:
            if self._closing:
                return
            if len(self._waiting) >= self._most:
                self._waiting.popleft()
                self.dropped += 1
            self._waiting.append(work)
            self._changed.notify_all()

    def flush(self, timeout_s: float) -> bool:
        """Wait until all is done; whether it was, within the time."""
        with self._changed:
            return self._changed.wait_for(lambda: not self._waiting and not self._busy, timeout_s)

    def close(self, timeout_s: float = 1.0) -> None:
        """Drop what waits, and end the thread; a request in flight may last, so that the thread is a daemon."""
        with self._changed:
            self._closing = True
            self._waiting.clear()
            self._changed.notify_all()
        self._thread.join(timeout_s)

    def _run(self) -> None:
        while True:
            with self._changed:
                self._busy = False
                self._changed.notify_all()
                self._changed.wait_for(lambda: self._waiting or self._closing)
                if self._closing:
                    return
                work = self._waiting.popleft()
                self._busy = True
            try:
                work()
            except Exception as error:  # noqa: BLE001 - one bad message, or a server that is away, must not end the thread
                self.failed += 1
                logging.getLogger(__name__).warning("%s: %s", self._thread.name, error)
