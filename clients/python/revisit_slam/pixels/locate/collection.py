"""Collection: the photographs of a gallery, each with its map and session, and those that ask."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from ...errors import RevisitError
from ...left_out import LeftOut
from ..frames import Frame, list_frames
from ..ids import plain_id
from ..tracking import session_name
from ..truth import labels_of

# The server asks at most this many maps at once.
MAX_MAPS = 64
MAX_NAME = 100
SPLITS = ("gallery", "query")
FLOOR_PREFIX, VIDEO_PREFIX = "floor-", "video-"


@dataclass(frozen=True, eq=False)
class Shot:
    """A photograph: the map that its floor is (its video's, where no floor is known), and its session."""

    frame: Frame
    map: str
    session: str
    is_judged: bool


@dataclass(frozen=True)
class Collection:
    """The gallery and the photographs that ask."""

    gallery: list[Shot]
    queries: list[Shot]
    left_out: LeftOut

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
    left_out, columns = LeftOut(), {"floor": (), **({"split": SPLITS} if is_one else {})}
    parts: dict[str, list[Shot]] = {part: [] for part in SPLITS}
    for folder, part in zip((gallery,) if is_one else (gallery, queries), SPLITS):
        frames = list_frames(folder, left_out)
        labels = labels_of(truth, frames, columns, left_out) if truth is not None else {frame.id: (None,) for frame in frames}
        for frame in frames:
            if frame.id in labels:
                floor, *split = labels[frame.id]
                parts[split[0] if split else part].append(_shot(frame, floor))
    for part, shots in parts.items():
        if not shots:
            raise RevisitError(f"{truth}: no photograph of the folder has the split {part}")
    collection = Collection(*parts.values(), left_out)
    if len(collection.maps) > MAX_MAPS:
        what = "floors" if collection.is_judged else "videos"
        raise RevisitError(f"--gallery: {len(collection.maps)} {what}; at most {MAX_MAPS} can be asked at once")
    return collection


def _shot(frame: Frame, floor: str | None) -> Shot:
    session = session_name(frame.video, 1)
    if floor is None:
        return Shot(frame, VIDEO_PREFIX + session, session, is_judged=False)
    return Shot(frame, FLOOR_PREFIX + plain_id(floor, MAX_NAME), session, is_judged=True)
