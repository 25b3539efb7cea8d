"""Blocking client."""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator
from types import TracebackType
from typing import Any

import httpx

from . import bulk
from .call import Call, segment
from .events import EventParser
from .lines import LineSplitter
from .models import BulkLine, Event
from .operations import Operations
from .problems import ProblemError, ServerUnreachable, problem_of
from .retries import Retries
from .settings import DEFAULT_URL, EVENTS_SILENCE_S, EXPORT_SILENCE_S, TIMEOUT_S, http_settings, proxy_to


class Client(Operations):
    """A connection pool to one server; one client may serve many threads.

    Bodies are sent with zstd. Refusals are raised as `ProblemError`; 429, 503 and broken connections are tried again
    within `retries`.
    """

    def __init__(
        self,
        url: str = DEFAULT_URL,
        *,
        key: str | None = None,
        timeout_s: float = TIMEOUT_S,
        retries: Retries | None = None,
        compress: bool = True,
    ) -> None:
        self._http = httpx.Client(**http_settings(url, key, timeout_s))
        self._retries = retries or Retries()
        self._compress = compress

    def put_keyframes(self, map: str, items: Iterable[bulk.Item]) -> Iterator[BulkLine]:
        """Store keyframes from any iterable, in batches; yield the outcome of each, in order.

        An item that is refused carries its `problem`; the others are stored. Items are drawn as batches are sent.
        """
        before = 0
        for body in bulk.batches(items):
            lines = bulk.lines_of(self._call(bulk.call_of(map, body)), before)
            yield from lines
            before += len(lines)

    def listen(self, map: str, *, since: int = 0, stop_when_idle_s: float | None = None) -> Iterator[Event]:
        """Yield the events of a map after number `since`, for ever, and resume where the stream breaks.

        With `stop_when_idle_s` the iterator ends once nothing happened for that long.
        """
        parser, attempt, broken_since = EventParser(since), 0, time.monotonic()
        silence_s = EVENTS_SILENCE_S if stop_when_idle_s is None else min(stop_when_idle_s, EVENTS_SILENCE_S)
        path = f"/v1/maps/{segment(map)}/events"
        last_event = time.monotonic()
        while True:
            try:
                timeout = httpx.Timeout(TIMEOUT_S, read=silence_s)
                headers = {"last-event-id": str(parser.last), "accept": "text/event-stream"}
                with self._http.stream("GET", path, headers=headers, timeout=timeout) as response:
                    if response.status_code >= 400:
                        response.read()
                        raise problem_of(response)
                    for line in response.iter_lines():
                        attempt, broken_since = 0, time.monotonic()
                        event = parser.line(line)
                        if event is not None:
                            yield event
                            last_event = time.monotonic()
                        elif stop_when_idle_s is not None and time.monotonic() - last_event >= stop_when_idle_s:
                            return
                failure: Exception = httpx.RemoteProtocolError("the stream ended")
            except (httpx.TransportError, ProblemError) as error:
                failure = error
            parser.broken()
            if stop_when_idle_s is not None and time.monotonic() - last_event >= stop_when_idle_s:
                return
            self._wait(attempt, broken_since, failure, repeatable=True)
            attempt += 1

    def export_map(self, map: str) -> Iterator[bytes]:
        """Yield the lines of a map's recording, as `revisit replay` plays it, without their newlines.

        A stream that breaks raises `ServerUnreachable`: the lines so far are not the whole map.
        """
        path, lines = f"/v1/maps/{segment(map)}/export", LineSplitter()
        try:
            with self._http.stream("GET", path, timeout=httpx.Timeout(TIMEOUT_S, read=EXPORT_SILENCE_S)) as response:
                if response.status_code >= 400:
                    response.read()
                    raise problem_of(response)
                for piece in response.iter_bytes():
                    yield from lines.feed(piece)
        except httpx.TransportError as error:
            raise unreachable(self._http.base_url, error) from error

    def close(self) -> None:
        """Close all connections."""
        self._http.close()

    def __enter__(self) -> Client:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def once(self, call: Call) -> Any:
        """Send a request without any retry."""
        return self._call(call, Retries(total_s=0))

    def _call(self, call: Call, retries: Retries | None = None) -> Any:
        content, headers = call.content(self._compress)
        begun, attempt = time.monotonic(), 0
        while True:
            try:
                response = self._http.request(call.method, call.path, params=call.params(), headers=headers, content=content)
                if response.status_code < 400:
                    return call.decode(response.content)
                failure: Exception = problem_of(response)
            except httpx.TransportError as error:
                failure = error
            self._wait(attempt, begun, failure, call.repeatable, retries)
            attempt += 1

    def _wait(self, attempt: int, begun: float, failure: Exception, repeatable: bool, retries: Retries | None = None) -> None:
        """Wait before the next try, or raise the failure where none is left."""
        delay = (retries or self._retries).delay(attempt, time.monotonic() - begun, failure, repeatable)
        if delay is not None:
            time.sleep(delay)
        elif isinstance(failure, ProblemError):
            raise failure
        else:
            raise unreachable(self._http.base_url, failure) from failure


def unreachable(url: httpx.URL, failure: Exception) -> ServerUnreachable:
    """Return the error for a server that gives no answer."""
    proxy = proxy_to(url)
    way = f" by the environment's proxy {proxy.url} (NO_PROXY={url.host} goes without it)" if proxy else ""
    return ServerUnreachable(f"no answer from {url}{way}: {failure or type(failure).__name__}")
