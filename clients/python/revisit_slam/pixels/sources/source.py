"""Source: photographs in order, with what is measured and what is guessed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from ...errors import RevisitError
from ...left_out import LeftOut
from ..frames import Frame
from ..ids import ids_of
from ..trajectory import Trajectory

ROTATIONS = "rotations between overlapping pictures"


@dataclass(frozen=True)
class Source:
    """Photographs to play."""

    frames: list[Frame]
    title: str
    poses: str = ROTATIONS
    """Where poses come from, as a person reads it."""
    distances: str = "assumed"
    """Where the distances of signs come from."""
    metric: bool = True
    assumed: list[str] = field(default_factory=list)
    """What nobody told, and is taken for granted."""
    left_out: LeftOut = field(default_factory=LeftOut)
    """What is not played; playing adds to it."""

    @property
    def count(self) -> int:
        """How many pictures can be read, as far as it was tried."""
        return sum(frame.shown not in self.left_out for frame in self.frames)

    def checked(self) -> Source:
        """Return it; where nothing of it can be read that is an error."""
        if not self.count:
            raise RevisitError("; ".join((f"{self.title}: nothing to play", *self.told()[1:])))
        return self

    def told(self) -> list[str]:
        """Return what is read, assumed and left out."""
        read = f"reads {self.count} pictures; poses: {self.poses}; distances of signs: {self.distances}"
        return [read, *self.left_out.told(), *(f"assumed: {one}" for one in self.assumed)]

    def summary(self) -> str:
        """Return it in one line."""
        return f"{self.title}: {'; '.join(self.told())}"

    def along(self, trajectory: Trajectory, told: str | None = None, moving_from_camera: np.ndarray | None = None) -> Source:
        """Return it with the poses of a trajectory, of the camera or of what it sits on; frames that have none are left out."""
        kept, moving_from_camera = [], np.eye(4) if moving_from_camera is None else moving_from_camera
        self.left_out.add_all(trajectory.left_out, trajectory.name)
        self.assumed.extend(trajectory.assumed)
        stamps, (first, last) = [(frame.stamp_ns or 0) / 1e9 for frame in self.frames] or [0], trajectory.span_s
        spans = f"poses from {first:.3f} to {last:.3f} s, photographs from {min(stamps):.3f} to {max(stamps):.3f} s"
        for frame in self.frames:
            pose = trajectory.at(frame.stamp_ns) if frame.stamp_ns is not None else None
            if pose is None:
                self.left_out.add(frame.shown, f"no pose near its time: {spans}")
            else:
                kept.append(replace(frame, session_from_camera=pose @ moving_from_camera))
        return replace(self, frames=kept, poses=told or f"those of {trajectory.name}")


def listed(
    file: Path, folder: Path, form: str, rows: list[tuple[int, list[str]]], time_ns: Callable[[str], int], left_out: LeftOut
) -> list[Frame]:
    """Return the pictures in `folder` that a file lists, in order of time; bad rows are left out, and what is not there."""
    frames = []
    for number, row in rows:
        with left_out.unless(f"{file}, line {number}", f"no row of `{form}`"):
            frames.append(Frame("", folder / row[1], "", number, time_ns(row[0])))
    if rows and not frames:
        raise RevisitError(f"{file}: no row of `{form}` in it")
    ids = ids_of((frame.path for frame in frames), folder)
    frames.sort(key=lambda frame: (frame.stamp_ns, frame.path))
    return there([replace(frame, id=ids[frame.path]) for frame in frames], left_out)


def there(frames: list[Frame], left_out: LeftOut) -> list[Frame]:
    """Return the frames whose files are there."""
    for frame in frames:
        if not frame.path.is_file():
            left_out.add(frame.shown, "listed, but no such file")
    return [frame for frame in frames if frame.shown not in left_out]


def every(frames: list[Frame], every_s: float) -> list[Frame]:
    """Return frames at least so many seconds apart; their times must be known."""
    kept: list[Frame] = []
    for frame in frames:
        if not too_near(kept, frame.stamp_ns or 0, every_s):
            kept.append(frame)
    return kept


def too_near(kept: list[Frame], stamp_ns: int, every_s: float) -> bool:
    """Whether the last frame kept was taken less than so many seconds before; 0 keeps all."""
    if not kept or kept[-1].stamp_ns is None:
        return False
    # A millisecond of grace: 30 pictures a second are 33.3 ms apart. One that comes late is no near one.
    return 0 <= stamp_ns - kept[-1].stamp_ns < every_s * 1e9 - 1e6
