"""SQLite file: opened for reading only, whatever wrote it."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ..errors import RevisitError
from .damage import told_of
from .limits import MAX_PIECE_BYTES

MAGIC = b"SQLite format 3\0"
CACHE_KIB = 16 * 1024


@contextmanager
def reading(path: Path) -> Iterator[sqlite3.Connection]:
    """Open a database; nothing is written to it or beside it. What SQLite refuses is one line."""
    with told_of(path, "SQLite"):
        connection = sqlite3.connect(f"{path.absolute().as_uri()}?mode=ro", uri=True)
        try:
            if hasattr(connection, "setlimit"):  # Since Python 3.11.
                connection.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, MAX_PIECE_BYTES)
            connection.execute(f"pragma cache_size=-{CACHE_KIB}")
            # Large sorts go to disk.
            connection.execute("pragma temp_store=1")
            # A damaged file must not call functions from its schema.
            connection.execute("pragma trusted_schema=off")
            yield connection
        finally:
            connection.close()


def tables(path: Path) -> dict[str, set[str]]:
    """Return the columns of each table."""
    with reading(path) as connection:
        names = [name for (name,) in connection.execute("select name from sqlite_master where type = 'table'")]
        return {name: {row[1] for row in connection.execute(f"pragma table_info({_quoted(name)})")} for name in names}


def need_columns(path: Path, found: dict[str, set[str]], needed: dict[str, tuple[str, ...]], system: str) -> None:
    """Refuse a database without what a system's databases have."""
    for table, columns in needed.items():
        missing = [column for column in columns if column not in found.get(table, set())]
        if missing:
            what = f"table {table}" if table not in found else f"column {missing[0]} in table {table}"
            raise RevisitError(f"{path}: no {what}, which the {system} has")


def _quoted(name: str) -> str:
    return '"' + name.replace('"', '""') + '"'
