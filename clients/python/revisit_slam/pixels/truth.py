"""Truth: on which floor each photograph was taken, and the count of right and wrong loops."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from ..errors import RevisitError
from ..files import records_of
from ..left_out import LeftOut
from .frames import Frame

# Nearer frames of one video show the same passage: naming one of them is no loop found.
MIN_FRAMES_APART = 10
ENDING = re.compile(r"\.(jpe?g|png|bmp|webp|tiff?|hei[cf]|hif)$", re.IGNORECASE)


def labels_of(
    path: Path, frames: Sequence[Frame], columns: Mapping[str, Sequence[str]], left_out: LeftOut
) -> dict[str, tuple[str, ...]]:
    """Return what a CSV's columns say of each photograph, by its id; a column with values has no others.

    A row names a photograph by its id, its path or the end of that, or a stem that no other row has.

    Raises:
        RevisitError: Half of the photographs, or more, have no row.
    """
    rows: dict[str, tuple[str, ...]] = {}
    twice = set()
    for line, record in records_of(path, ("frame", *columns)):
        where, name, row = f"{path.name}, line {line}", _plain(record["frame"]), tuple(record[column] for column in columns)
        strange = [(column, record[column]) for column, known in columns.items() if known and record[column] not in known]
        if not name or not all(row):
            left_out.add(where, f"`frame` and `{'` and `'.join(columns)}` must not be empty")
        elif strange:
            left_out.add(where, f"`{strange[0][0]}` is `{strange[0][1]}`; known are {' and '.join(columns[strange[0][0]])}")
        elif rows.setdefault(name, row) != row:
            twice.add(name)
            left_out.add(where, f"{record['frame']} stands there twice, with different values")
    rows = {name: row for name, row in rows.items() if name not in twice}
    stems: dict[str, set[tuple[str, ...]]] = {}
    for name, row in rows.items():
        stems.setdefault(name.rsplit("/", 1)[-1], set()).add(row)
    found = {}
    for frame in frames:
        by_stem = stems.get(frame.path.stem, set())
        row = next((rows[name] for name in _names(frame) if name in rows), next(iter(by_stem)) if len(by_stem) == 1 else ())
        if row:
            found[frame.id] = row
    lacking = [frame.path.name for frame in frames if frame.id not in found]
    if lacking and 2 * len(lacking) >= len(frames):
        others = f" and {len(lacking) - 1} others" if len(lacking) > 1 else ""
        raise RevisitError("; ".join((f"{path}: no floor for {lacking[0]}{others}", *left_out.told())))
    for name in lacking:
        left_out.add(name, f"no floor in {path.name}, so not judged")
    return found


def _plain(name: str) -> str:
    """Return the name of a photograph without its ending; a number after a dot is none."""
    return ENDING.sub("", name.replace("\\", "/").removeprefix("./"))


def _names(frame: Frame) -> list[str]:
    """Return what a row may name a photograph by: its id, its path or the end of that."""
    parts = frame.path.parts
    return [frame.id, *(_plain("/".join(parts[start:])) for start in range(len(parts)))]


class Truth:
    """The floor (or place) of each photograph, from a CSV with columns `frame` and `floor`; some may have none."""

    def __init__(self, path: Path, frames: Iterable[Frame], left_out: LeftOut | None = None) -> None:
        self.left_out = left_out or LeftOut()
        self._frames = {frame.id: frame for frame in frames}
        labels = labels_of(path, list(self._frames.values()), {"floor": ()}, self.left_out)
        self._floors = {id: floor for id, (floor,) in labels.items()}

    def same_floor(self, one: str, other: str) -> bool:
        """Whether two keyframes were taken on one floor, as far as is known."""
        floors = self._floors
        return one not in floors or other not in floors or floors[one] == floors[other]

    def right(self, query: str, answer: str) -> bool:
        """Whether `answer` is a loop found: on the same floor, in another video or far enough in this one."""
        a, b = self._frames[query], self._frames[answer]
        is_far = a.video != b.video or abs(a.number - b.number) >= MIN_FRAMES_APART
        return is_far and {query, answer} <= self._floors.keys() and self.same_floor(query, answer)

    def lists(self, query: str, earlier: Iterable[str]) -> tuple[list[str], list[str]]:
        """Return the right answers among earlier keyframes, and those that are neither right nor wrong."""
        same = [id for id in earlier if self.same_floor(query, id)]
        return [id for id in same if self.right(query, id)], [id for id in same if not self.right(query, id)]


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
