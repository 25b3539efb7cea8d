"""Bridge: a host's keyframes go to the server, and the server's loops come back, in threads of their own.

A host's callback only leaves a message in an inbox. One thread turns messages into keyframes and puts them into a
`KeyframeSender`, which bridges outages; another asks, confirms and corrects. The host takes loops when it likes.
"""

from __future__ import annotations

import logging
import threading
from collections import deque
from collections.abc import Callable
from pathlib import Path
from typing import Any

from ..client import Client
from ..models import BulkLine
from ..problems import ProblemError, RevisitError, found
from ..sender import KeyframeSender, SenderStats
from .inbox import Inbox
from .loops import Loop, loop_of

# A node a second for four minutes, while its thread does something else.
MESSAGES = 256
# Questions and confirmations while the server is away; the oldest are dropped.
JOBS = 1024
LOOPS = 256
RETRY_S = 1.0
# Keyframes of a run whose storing is remembered.
MAX_STORED = 1_000_000


class Bridge:
    """A map of the server, for one host."""

    def __init__(
        self, client: Client, map: str, *, settings: dict[str, Any] | None = None, verify: str = "geometry", spill: Path | None = None
    ) -> None:
        """Begin; a map that is missing is made with `settings`, once the server is there."""
        self._client, self._map, self._verify = client, map, verify
        self._closing = threading.Event()
        self._messages, self._jobs = Inbox("revisit-messages", MESSAGES), Inbox("revisit-jobs", JOBS)
        self._found: deque[Loop] = deque(maxlen=LOOPS)
        self._stored: set[str] = set()
        self._told = threading.Condition()
        self._lines = 0
        self.asked = self.without_transform = self.refused = 0
        self._sender = KeyframeSender(client, map, spill=spill, on_line=self._line)
        # Before the first keyframe: one for a map that is missing would be refused.
        self._messages.put(lambda: self._make_map(settings or {}))

    def take_loops(self) -> list[Loop]:
        """Return the loops found since the last call."""
        found = []
        while self._found:
            found.append(self._found.popleft())
        return found

    def stats(self) -> SenderStats:
        """Return the figures of the sender."""
        return self._sender.stats()

    @property
    def dropped(self) -> int:
        """Messages and jobs that were dropped because a thread did not keep up, or failed."""
        return self._messages.dropped + self._jobs.dropped + self._messages.failed + self._jobs.failed

    def flush(self, timeout_s: float) -> bool:
        """Wait until everything is sent, asked and confirmed; whether it was, within the time."""
        if not self._messages.flush(timeout_s) or not self._sender.flush(timeout_s):
            return False
        return self._wait_for_lines(timeout_s) and self._jobs.flush(timeout_s)

    def _wait_for_lines(self, timeout_s: float) -> bool:
        """Wait until each keyframe's outcome is known here: the sender tells it after it counted it."""
        with self._told:
            stats = self._sender.stats()
            return self._told.wait_for(lambda: self._lines >= stats.sent + stats.refused, timeout_s)

    def close(self, timeout_s: float = 30.0) -> int:
        """Send what is left; return how many keyframes were not sent."""
        self._messages.flush(timeout_s)
        self._closing.set()
        self._messages.close()
        left = self._sender.close(timeout_s)
        self._jobs.close()
        return left

    def leave(self, work: Callable[[], None]) -> None:
        """Leave a message to the thread that turns them into keyframes."""
        self._messages.put(work)

    def send(self, id: str, body: dict[str, Any]) -> bool:
        """Send a keyframe; False where it had to be dropped."""
        return self._sender.put(id, body)

    def is_stored(self, id: str) -> bool:
        """Whether the server has a keyframe of this run."""
        with self._told:
            return id in self._stored

    def confirm(self, id: str, keyframe: str, candidate: str, query: str | None = None) -> None:
        """Tell the server of a loop that the host closed."""
        body = {"id": id, "keyframe": keyframe, "candidate": candidate} | ({"query": query} if query else {})
        self._jobs.put(lambda: self._client.confirm_loop(self._map, body))

    def correct(self, session: str, body: dict[str, Any], done: Callable[[bool], None]) -> None:
        """Send corrected poses; `done` is called in the bridge's thread with whether the server took them."""

        def work() -> None:
            taken = False
            try:
                self._client.correct_poses(self._map, {"session": session, **body})
                taken = True
            finally:
                done(taken)

        self._jobs.put(work)

    def _make_map(self, settings: dict[str, Any]) -> None:
        while not self._closing.is_set():
            try:
                if found(self._client.get_map, self._map) is None:
                    self._client.put_map(self._map, {"metric": True, "settings": settings})
                return
            except ProblemError as problem:
                if problem.status not in (429, 503):
                    raise
            except RevisitError:
                # Nothing is there yet; messages wait, the oldest are dropped.
                pass
            self._closing.wait(RETRY_S)

    def _line(self, line: BulkLine) -> None:
        with self._told:
            id = line.id if line.status < 300 else None
            if id is not None:
                if len(self._stored) < MAX_STORED:
                    self._stored.add(id)
                self._jobs.put(lambda: self._ask(id))
            else:
                self._refused(line)
            self._lines += 1
            self._told.notify_all()

    def _refused(self, line: BulkLine) -> None:
        self.refused += 1
        detail = line.problem.detail if line.problem is not None else f"status {line.status}"
        logging.getLogger(__name__).warning("keyframe %s is refused: %s", line.id, detail)

    def _ask(self, id: str) -> None:
        answer = self._client.query_loop(self._map, {"keyframe": id, "verify": self._verify})
        self.asked += 1
        loop = loop_of(answer)
        if loop is not None:
            self.without_transform += loop.candidate_from_query is None
            self._found.append(loop)
