"""Truth: on which floor each photograph was taken, and the count of right and wrong loops."""

from __future__ import annotations

import csv
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from pathlib import Path

from ..errors import RevisitError
from .frames import Frame

# Nearer frames of one video show the same passage: naming one of them is no loop found.
MIN_FRAMES_APART = 10


class Truth:
    """The floor (or place) of each photograph, from a CSV with columns `frame` and `floor`."""

    def __init__(self, path: Path, frames: Iterable[Frame]) -> None:
        floors: dict[str, str] = {}
        try:
            with path.open(newline="") as file:
                rows = csv.DictReader(file)
                if not {"frame", "floor"} <= set(rows.fieldnames or ()):
                    raise RevisitError(f"{path}: no columns `frame` and `floor` in its first line")
                stems: dict[str, set[str]] = {}
                for row in rows:
                    floors[row["frame"]] = row["floor"]
                    stems.setdefault(Path(row["frame"]).stem, set()).add(row["floor"])
                # A stem that two folders share names nothing.
                floors |= {stem: next(iter(found)) for stem, found in stems.items() if len(found) == 1 and stem not in floors}
        except (OSError, UnicodeDecodeError) as error:
            raise RevisitError(f"{path}: cannot be read: {error}") from error
        self._frames: dict[str, Frame] = {}
        self._floors: dict[str, str] = {}
        self._path = path
        for frame in frames:
            floor = next((floors[name] for name in _names(frame) if name in floors), None)
            if floor is None:
                raise RevisitError(f"{path}: no floor for {frame.path.name}")
            self._frames[frame.id], self._floors[frame.id] = frame, floor

    def same_floor(self, one: str, other: str) -> bool:
        """Whether two keyframes were taken on one floor."""
        return self._floors[one] == self._floors[other]

    def right(self, query: str, answer: str) -> bool:
        """Whether `answer` is a loop found: on the same floor, in another video or far enough in this one."""
        a, b = self._frames[query], self._frames[answer]
        return self.same_floor(query, answer) and (a.video != b.video or abs(a.number - b.number) >= MIN_FRAMES_APART)

    def lists(self, query: str, earlier: Iterable[str]) -> tuple[list[str], list[str]]:
        """Return the right answers among earlier keyframes, and those that are neither right nor wrong."""
        same = [id for id in earlier if self.same_floor(query, id)]
        return [id for id in same if self.right(query, id)], [id for id in same if not self.right(query, id)]


def _names(frame: Frame) -> list[str]:
    """Return what a row may name a photograph by: its id, its path or the end of that, its stem."""
    parts = frame.path.parts
    return [frame.id, *("/".join(parts[start:]) for start in range(len(parts))), frame.path.stem]


@dataclass
class Score:
    """Figures of a run; `right` and `wrong` judge `best`, `loops_wrong` every keyframe named."""

    queries: int = 0
    accepted: int = 0
    right: int = 0
    wrong: int = 0
    loops_wrong: int = 0
    seconds: float = 0.0

    def count(self, truth: Truth | None, query: str, verdict: str, best: str | None, loops: Iterable[str]) -> None:
        """Count one answer."""
        self.queries += 1
        accepted = verdict == "loop"
        self.accepted += accepted
        if truth is None:
            return
        if accepted and best is not None:
            self.right += truth.right(query, best)
            self.wrong += not truth.same_floor(query, best)
        self.loops_wrong += any(not truth.same_floor(query, loop) for loop in loops)

    def figures(self, judged: bool) -> dict[str, float]:
        """Return them as `--json` prints them; without truth right and wrong are not known."""
        figures = asdict(self)
        return figures if judged else {name: figures[name] for name in ("queries", "accepted", "seconds")}
