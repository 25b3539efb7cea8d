"""SQLite file: opened for reading only, whatever wrote it."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ..errors import RevisitError
from ..files import first_bytes
from .damage import told_of
from .limits import MAX_PIECE_BYTES

MAGIC = b"SQLite format 3\0"
CACHE_KIB = 16 * 1024
WRITTEN = "another program writes to it: end that, or import a copy"


@contextmanager
def reading(path: Path) -> Iterator[sqlite3.Connection]:
    """Open a database; nothing is written to it or beside it. What SQLite refuses is one line."""
    with told_of(path, "SQLite"):
        unended = not_ended(path)
        # Immutable: without a lock, at which RTAB-Map ends if it has the file open, and without files of a log beside it.
        # That nobody wrote meanwhile is checked instead. A journal that is to be played back is SQLite's to judge.
        way = "mode=ro" if unended else "mode=ro&immutable=1"
        _refuse_written(path)
        state = _state(path)
        connection = sqlite3.connect(f"{path.absolute().as_uri()}?{way}", uri=True)
        try:
            if hasattr(connection, "setlimit"):  # Since Python 3.11.
                connection.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, MAX_PIECE_BYTES)
            # Names of files may be in another encoding than texts are.
            connection.text_factory = lambda text: text.decode("utf-8", "surrogateescape")
            connection.execute(f"pragma cache_size=-{CACHE_KIB}")
            # Large sorts go to disk.
            connection.execute("pragma temp_store=1")
            # A damaged file must not call functions from its schema.
            connection.execute("pragma trusted_schema=off")
            yield connection
            _refuse_written(path)
            if _state(path) != state:
                raise RevisitError(f"{path}: {WRITTEN}")
        except sqlite3.DatabaseError as error:
            if "locked" in str(error) or _state(path) != state:
                raise RevisitError(f"{path}: {WRITTEN}") from error
            if unended:
                raise RevisitError(f"{path}: {error}; {unended}") from error
            raise
        finally:
            connection.close()


def _refuse_written(path: Path) -> None:
    """Refuse a file that another program is writing to; a lock is held for an instant only."""
    # Of a database with a log SQLite makes the log's files even to read.
    if first_bytes(path)[18:19] == b"\2" or not_ended(path):
        return
    probe = sqlite3.connect(f"{path.absolute().as_uri()}?mode=ro", uri=True)
    try:
        probe.execute("pragma schema_version").fetchall()
    except sqlite3.OperationalError as error:
        if "locked" in str(error):
            raise RevisitError(f"{path}: {WRITTEN}") from error
    except sqlite3.DatabaseError:
        pass  # The reader says what is wrong with it.
    finally:
        probe.close()


def _state(path: Path) -> tuple[int, int, bytes]:
    """Return what changes with every write: size, time, and the counter of changes in the header."""
    found = path.stat()
    return found.st_size, found.st_mtime_ns, first_bytes(path)[24:28]


def not_ended(path: Path) -> str:
    """Return what says that writing to a database did not end, and the next step; nothing where nothing does."""
    for beside in (path.with_name(f"{path.name}-journal"), path.with_name(f"{path.name}-wal")):
        if beside.exists() and beside.stat().st_size:
            return f"writing did not end, says {beside.name}: open it once with what wrote it, or `sqlite3 {path} .tables`"
    return ""


def tables(path: Path) -> dict[str, set[str]]:
    """Return the columns of each table."""
    with reading(path) as connection:
        names = [name for (name,) in connection.execute("select name from sqlite_master where type = 'table'")]
        return {name: {row[1] for row in connection.execute(f"pragma table_info({_quoted(name)})")} for name in names}


def need_columns(path: Path, needed: dict[str, tuple[str, ...]], system: str) -> dict[str, set[str]]:
    """Return the columns of each table; a database without what a system's databases have is refused."""
    found = tables(path)
    for table, columns in needed.items():
        missing = [column for column in columns if column not in found.get(table, set())]
        if missing:
            what = f"table {table}" if table not in found else f"column {missing[0]} in table {table}"
            raise RevisitError(f"{path}: no {what}, which the {system} has")
    return found


def _quoted(name: str) -> str:
    return '"' + name.replace('"', '""') + '"'
