"""Ahead: work on things in threads, while what came of the first ones is taken; and how far it has come."""

from __future__ import annotations

import itertools
import sys
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from typing import TypeVar

Thing = TypeVar("Thing")
Made = TypeVar("Made")


def ahead(
    things: Iterable[Thing], work: Callable[[Thing], Made], threads: int, done: Callable[[int], None]
) -> Iterator[Made]:
    """Yield what is made of each thing, in order, and tell how many are done; only a few things are taken ahead of time."""
    with ThreadPoolExecutor(threads) as pool:
        begun: deque[Future[Made]] = deque()
        count = 0
        try:
            for thing in itertools.chain(things, [None]):
                if thing is not None:
                    begun.append(pool.submit(work, thing))
                while begun and (thing is None or len(begun) > 2 * threads):
                    yield begun.popleft().result()
                    count += 1
                    done(count)
        finally:
            for future in begun:
                future.cancel()


def progress(what: str, total: int) -> Callable[[int], None]:
    """Return what tells a terminal how many are done."""

    def show(done: int) -> None:
        if sys.stderr.isatty():
            print(f"\r{what}: {done} of {total} ", end="\n" if done == total else "", file=sys.stderr, flush=True)

    return show
