"""Client to be awaited."""

from __future__ import annotations

import asyncio
import time
from collections.abc import AsyncIterable, AsyncIterator, Iterable
from types import TracebackType
from typing import Any

import httpx

from . import bulk
from .call import Call, segment
from .client import unreachable
from .events import EventParser
from .lines import LineSplitter
from .models import BulkLine, Event
from .operations import AsyncOperations
from .problems import ProblemError, problem_of
from .retries import Retries
from .settings import DEFAULT_URL, EVENTS_SILENCE_S, EXPORT_SILENCE_S, TIMEOUT_S, http_settings


class AsyncClient(AsyncOperations):
    """The same as `Client`, with operations to be awaited."""

    def __init__(
        self,
        url: str = DEFAULT_URL,
        *,
        key: str | None = None,
        timeout_s: float = TIMEOUT_S,
        retries: Retries | None = None,
        compress: bool = True,
    ) -> None:
        self._http = httpx.AsyncClient(**http_settings(url, key, timeout_s))
        self._retries = retries or Retries()
        self._compress = compress

    async def put_keyframes(self, map: str, items: Iterable[bulk.Item] | AsyncIterable[bulk.Item]) -> AsyncIterator[BulkLine]:
        """Store keyframes from any iterable, plain or asynchronous; yield the outcome of each, in order."""
        before = 0
        async for part in _parts(items):
            for body in bulk.batches(part):
                lines = bulk.lines_of(await self._call(bulk.call_of(map, body)), before)
                for line in lines:
                    yield line
                before += len(lines)

    async def listen(self, map: str, *, since: int = 0, stop_when_idle_s: float | None = None) -> AsyncIterator[Event]:
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
                async with self._http.stream("GET", path, headers=headers, timeout=timeout) as response:
                    if response.status_code >= 400:
                        await response.aread()
                        raise problem_of(response)
                    async for line in response.aiter_lines():
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
            await self._wait(attempt, broken_since, failure, repeatable=True)
            attempt += 1

    async def export_map(self, map: str) -> AsyncIterator[bytes]:
        """Yield the lines of a map's recording, as `revisit replay` plays it, without their newlines.

        A stream that breaks raises `ServerUnreachable`: the lines so far are not the whole map.
        """
        path, lines = f"/v1/maps/{segment(map)}/export", LineSplitter()
        timeout = httpx.Timeout(TIMEOUT_S, read=EXPORT_SILENCE_S)
        try:
            async with self._http.stream("GET", path, timeout=timeout) as response:
                if response.status_code >= 400:
                    await response.aread()
                    raise problem_of(response)
                async for piece in response.aiter_bytes():
                    for line in lines.feed(piece):
                        yield line
        except httpx.TransportError as error:
            raise unreachable(self._http.base_url, error) from error

    async def close(self) -> None:
        """Close all connections."""
        await self._http.aclose()

    async def __aenter__(self) -> AsyncClient:
        return self

    async def __aexit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        await self.close()

    async def _call(self, call: Call) -> Any:
        content, headers = call.content(self._compress)
        begun, attempt = time.monotonic(), 0
        while True:
            try:
                answer = await self._http.request(call.method, call.path, params=call.params(), headers=headers, content=content)
                if answer.status_code < 400:
                    return call.decode(answer.content)
                failure: Exception = problem_of(answer)
            except httpx.TransportError as error:
                failure = error
            await self._wait(attempt, begun, failure, call.repeatable)
            attempt += 1

    async def _wait(self, attempt: int, begun: float, failure: Exception, repeatable: bool) -> None:
        """Wait before the next try, or raise the failure where none is left."""
        delay = self._retries.delay(attempt, time.monotonic() - begun, failure, repeatable)
        if delay is not None:
            await asyncio.sleep(delay)
        elif isinstance(failure, ProblemError):
            raise failure
        else:
            raise unreachable(self._http.base_url, failure) from failure


async def _parts(items: Iterable[bulk.Item] | AsyncIterable[bulk.Item]) -> AsyncIterator[Iterable[bulk.Item]]:
    """Yield a plain iterable as it is, and an asynchronous one batch by batch."""
    if not isinstance(items, AsyncIterable):
        yield items
        return
    part: list[bulk.Item] = []
    async for item in items:
        part.append(item)
        if len(part) >= bulk.MAX_BATCH_ITEMS:
            yield part
            part = []
    yield part
