"""Point ids: which map points were placed already, in one bit each."""

from __future__ import annotations

from collections.abc import Iterable

from ..errors import RevisitError

PAGE_BITS = 65_536
# 128 MiB of bits. Systems number points one after the other; what needs more is not numbered but damaged.
MAX_PAGES = 16_384
NEAR_IDS = MAX_PAGES * PAGE_BITS


class PointIds:
    """A set of ids that are near each other."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._pages: dict[int, bytearray] = {}
        self.count = 0

    def new_of(self, ids: Iterable[int]) -> list[int]:
        """Add ids; return those that were not in it, in order."""
        new = []
        for id in ids:
            at, bit = divmod(id, PAGE_BITS)
            page = self._pages.get(at)
            if page is None:
                if len(self._pages) >= MAX_PAGES:
                    raise RevisitError(f"{self._name}: its map points are numbered without any order (one is {id})")
                page = self._pages[at] = bytearray(PAGE_BITS // 8)
            byte, mask = bit >> 3, 1 << (bit & 7)
            if not page[byte] & mask:
                page[byte] |= mask
                new.append(id)
        self.count += len(new)
        return new
