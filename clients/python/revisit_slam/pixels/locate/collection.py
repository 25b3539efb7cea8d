"""Collection: the photographs of a gallery, each with its map and session, and those that ask."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from ...errors import RevisitError
from ..frames import Frame, list_frames
from ..tracking import session_name
from .floors import Floors

# The server asks at most this many maps at once.
MAX_MAPS = 64
MAX_NAME = 100
FLOOR_PREFIX, VIDEO_PREFIX = "floor-", "video-"


@dataclass(frozen=True, eq=False)
class Shot:
    """A photograph: the map that its floor is (its video's, where no floor is known), and its session."""

    frame: Frame
    map: str
    session: str
    is_judged: bool

    @property
    def name(self) -> str:
        """What the answer calls the photograph."""
        return self.frame.id


@dataclass(frozen=True)
class Collection:
    """The gallery and the photographs that ask."""

    gallery: list[Shot]
    queries: list[Shot]

    @property
    def maps(self) -> list[str]:
        """The maps of the gallery, in order."""
        return sorted({shot.map for shot in self.gallery})

    @property
    def is_judged(self) -> bool:
        """Whether it is known on which floor the photographs were taken."""
        return self.queries[0].is_judged


def open_collection(gallery: Path, queries: Path, truth: Path | None) -> Collection:
    """Return the photographs of one folder (given twice) as the CSV splits them, or of two folders."""
    is_one = gallery.resolve() == queries.resolve()
    if is_one and truth is None:
        raise RevisitError(f"--queries {queries}: the gallery's own folder; --truth CSV with a column `split` must part it")
    floors = Floors(truth, with_split=is_one) if truth is not None else None
    if is_one:
        assert floors is not None
        known, asking = floors.split(list_frames(gallery))
    else:
        known, asking = list_frames(gallery), list_frames(queries)
    collection = Collection([_shot(frame, floors) for frame in known], [_shot(frame, floors) for frame in asking])
    _check_maps(collection)
    return collection


def _shot(frame: Frame, floors: Floors | None) -> Shot:
    session = session_name(frame.video, 1)
    if floors is None:
        return Shot(frame, VIDEO_PREFIX + session, session, is_judged=False)
    floor = re.sub(r"[^A-Za-z0-9._:-]", "_", floors.of(frame).floor)[:MAX_NAME]
    return Shot(frame, FLOOR_PREFIX + floor, session, is_judged=True)


def _check_maps(collection: Collection) -> None:
    if len(collection.maps) > MAX_MAPS:
        what = "floors" if collection.is_judged else "videos"
        raise RevisitError(f"--gallery: {len(collection.maps)} {what}; at most {MAX_MAPS} can be asked at once")
