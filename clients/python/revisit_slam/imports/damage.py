"""Damage: what a broken file leads a reader to becomes one line that names the file, and a broken part of it is left out."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ..errors import RevisitError
from ..files import how_to_mend
from ..left_out import WRONG, LeftOut

MAX_REASONS = 10


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
        mended = how_to_mend(path)
        told += f"; {mended}" if mended else ""
        raise RevisitError(f"{path}: {reader} cannot read it, it is damaged or of another form: {told}") from error


class Account:
    """What a person should know of a file that was read: notes, and the parts of it that were left out."""

    def __init__(self, path: Path | str) -> None:
        self.path = path
        self.notes: list[str] = []
        self.left_out = LeftOut()

    @contextmanager
    def part(self, name: str) -> Iterator[str]:
        """Read a part by itself: where anything is wrong with it, it is left out. Yields how its errors begin.

        What is wrong with the file as a whole, such as SQLite's errors, goes on.
        """
        where = f"{self.path}: {name}"
        try:
            yield where
        except WRONG as error:
            why = str(error).removeprefix(where).lstrip(": ") or type(error).__name__
            self.left_out.add(name, why.splitlines()[0])

    def told(self) -> list[str]:
        """Return it line by line; of many reasons the first."""
        lines = self.left_out.told()
        others = [f"and left out for {len(lines) - MAX_REASONS} other reasons"] if len(lines) > MAX_REASONS else []
        return [*self.notes, *lines[:MAX_REASONS], *others]
