"""Damage: whatever a broken file leads a reader to becomes one line that names the file."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ..errors import RevisitError

MAX_TOLD = 600


@contextmanager
def told_of(path: Path, reader: str) -> Iterator[None]:
    """Raise a `RevisitError` with the file's name for any failure inside.

    The readers check what they read, and say what is wrong. This is for what a library raises, of types of its own.
    """
    try:
        yield
    except RevisitError:
        raise
    except OSError as error:
        raise RevisitError(f"{path}: cannot be read: {error.strerror or error}") from error
    except MemoryError as error:
        raise RevisitError(f"{path}: {reader} finds a part in it that does not fit into memory: the file is damaged") from error
    except Exception as error:  # noqa: BLE001 - a damaged file leads libraries to anything
        told = (str(error) or type(error).__name__).splitlines()[0]
        raise RevisitError(f"{path}: {reader} cannot read it, it is damaged or of another form: {told}") from error


@contextmanager
def in_one_line() -> Iterator[None]:
    """Keep what a damaged file calls its parts from being printed as it is: names may be long, or have lines of their own."""
    try:
        yield
    except RevisitError as error:
        told = "".join(letter if letter.isprintable() else "?" for letter in str(error))
        raise RevisitError(told if len(told) <= MAX_TOLD else f"{told[:MAX_TOLD]} ..") from error
