"""Point store: where map points are, by id, on disk: files list points in one order and keyframes use them in another."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterable
from types import TracebackType

from ..errors import RevisitError
from .damage import Account
from .limits import MAX_COORDINATE_M, MAX_POINT_ID

ROWS_AT_ONCE = 20_000
IDS_AT_ONCE = 500
CACHE_KIB = 32 * 1024
# A point's number in the order of the file, and where it is.
Placed = tuple[int, tuple[float, float, float]]


class PointStore:
    """A table of positions, in a file of SQLite's own that ends with it.

    Ids are of 64 bits, with a sign or without. Where one is none that the server takes, as hashes are not, it is told of
    each point by its number in the order of the file.
    """

    def __init__(self, account: Account) -> None:
        self._account = account
        self.are_far = False
        # A bit for each point, by its number.
        self._seen = bytearray()
        self._added = 0
        self._rows: list[tuple[int, int, float | None, float, float]] = []
        self._table = sqlite3.connect("", isolation_level=None)
        # Lost with the run, so that nothing need survive a crash.
        for pragma in ("journal_mode=off", "synchronous=off", f"cache_size=-{CACHE_KIB}"):
            self._table.execute(f"pragma {pragma}")
        self._table.execute("create table points(id integer primary key, number integer, x real, y real, z real)")
        self._table.execute("begin")
        self.count = self.seen = 0

    def add(self, id: int, x: float, y: float, z: float) -> None:
        """Add a point; of one id the last counts, and one at no place is left out."""
        is_placed = all(abs(value) <= MAX_COORDINATE_M for value in (x, y, z))
        if not is_placed:
            self._account.left_out.add(f"point {id}", "its position is no place")
        self.are_far |= not 0 <= id <= MAX_POINT_ID
        self._rows.append((signed(id), self._added, x if is_placed else None, y, z))
        self._added += 1
        self.count += is_placed
        if len(self._rows) >= ROWS_AT_ONCE:
            self._flush()

    def find(self, ids: Iterable[int], where: str, *, may_lack: bool = False) -> dict[int, Placed]:
        """Return points by the ids that the server is told; `where` names what observes them.

        Those at no place are left out, and with `may_lack` those that are not there.
        """
        self._flush()
        found: dict[int, Placed] = {}
        ids, there = list(ids), set()
        for start in range(0, len(ids), IDS_AT_ONCE):
            some = ids[start : start + IDS_AT_ONCE]
            marks = ",".join("?" * len(some))
            for id, number, x, y, z in self._table.execute(f"select * from points where id in ({marks})", some):
                there.add(id)
                if x is not None:
                    found[number if self.are_far else id] = (number, (x, y, z))
        missing = next((id for id in ids if id not in there), None)
        if missing is not None and not may_lack:
            raise RevisitError(f"{where} observes point {missing}, which is not there")
        return found

    def new_of(self, found: dict[int, Placed]) -> dict[int, tuple[float, float, float]]:
        """Return where those points are that no earlier keyframe has seen."""
        self._seen.extend(bytes(self._added // 8 + 1 - len(self._seen)))
        new = {}
        for id, (number, place) in found.items():
            byte, mask = number >> 3, 1 << (number & 7)
            if not self._seen[byte] & mask:
                self._seen[byte] |= mask
                new[id] = place
        self.seen += len(new)
        return new

    def _flush(self) -> None:
        # Sorted, so that a page is written once.
        self._rows.sort(key=lambda row: row[:2])
        self._table.executemany("insert or replace into points values (?, ?, ?, ?, ?)", self._rows)
        self._rows = []

    def __enter__(self) -> PointStore:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self._table.close()


def signed(id: int) -> int:
    """Return an id of 64 bits as the one with a sign that has the same bits."""
    return (id + 2**63) % 2**64 - 2**63
