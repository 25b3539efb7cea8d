"""Point store: where map points are, by id, on disk: files list points in one order and images use them in another."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterable
from pathlib import Path
from types import TracebackType

from ..errors import RevisitError
from .limits import MAX_COORDINATE_M, MAX_POINT_ID

ROWS_AT_ONCE = 20_000
IDS_AT_ONCE = 500
CACHE_KIB = 32 * 1024


class PointStore:
    """A table of positions in a folder of the run."""

    def __init__(self, folder: Path, name: str) -> None:
        self._name = name
        self._rows: list[tuple[int, float, float, float]] = []
        self._table = sqlite3.connect(folder / "points.db", isolation_level=None)
        # Lost with the run, so that nothing need survive a crash.
        for pragma in ("journal_mode=off", "synchronous=off", f"cache_size=-{CACHE_KIB}", "locking_mode=exclusive"):
            self._table.execute(f"pragma {pragma}")
        self._table.execute("create table points(id integer primary key, x real, y real, z real)")
        self._table.execute("begin")
        self.count = 0

    def add(self, id: int, x: float, y: float, z: float) -> None:
        """Add a point; of one id the last counts."""
        if not (0 <= id <= MAX_POINT_ID and all(abs(value) <= MAX_COORDINATE_M for value in (x, y, z))):
            raise RevisitError(f"{self._name}: point {id} at ({x:g}, {y:g}, {z:g}) is no map point")
        self._rows.append((id, x, y, z))
        if len(self._rows) >= ROWS_AT_ONCE:
            self._flush()

    def find(self, ids: Iterable[int], where: str, *, may_lack: bool = False) -> dict[int, tuple[float, float, float]]:
        """Return where points are; `where` names what observes them. With `may_lack` those that are not there are left out."""
        self._flush()
        found: dict[int, tuple[float, float, float]] = {}
        ids = list(ids)
        for start in range(0, len(ids), IDS_AT_ONCE):
            some = ids[start : start + IDS_AT_ONCE]
            marks = ",".join("?" * len(some))
            for id, *position in self._table.execute(f"select id, x, y, z from points where id in ({marks})", some):
                found[id] = tuple(position)
        missing = next((id for id in ids if id not in found), None)
        if missing is not None and not may_lack:
            raise RevisitError(f"{where} observes point {missing}, which is not there")
        return found

    def _flush(self) -> None:
        # Sorted, so that a page is written once.
        self._table.executemany("insert or replace into points values (?, ?, ?, ?)", sorted(self._rows))
        self.count += len(self._rows)
        self._rows = []

    def __enter__(self) -> PointStore:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self._table.close()
