"""Source: photographs in order, with what is measured and what is guessed."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from ...errors import RevisitError
from ...left_out import LeftOut
from ..frames import Frame
from ..trajectory import MAX_GAP_NS, Trajectory

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
    assumed: tuple[str, ...] = ()
    """What nobody told, and is taken for granted."""
    left_out: LeftOut = field(default_factory=LeftOut)
    """What is not played; playing adds to it."""

    def assuming(self, *told: str) -> Source:
        """Return it with more that is assumed."""
        return replace(self, assumed=(*self.assumed, *told))

    def told(self) -> list[str]:
        """Return what is read, assumed and left out."""
        count = sum(frame.shown not in self.left_out for frame in self.frames)
        read = f"reads {count} pictures; poses: {self.poses}; distances of signs: {self.distances}"
        return [read, *(f"assumed: {one}" for one in self.assumed), *self.left_out.told()]

    def summary(self) -> str:
        """Return it in one line."""
        return f"{self.title}: {'; '.join(self.told())}"

    def nothing(self) -> RevisitError:
        """Return the error that nothing of it can be played."""
        return RevisitError("; ".join((f"{self.title}: nothing to play", *self.left_out.told())))

    def along(self, trajectory: Trajectory, told: str | None = None) -> Source:
        """Return it with the poses of a trajectory; frames that have none are left out.

        Raises:
            RevisitError: No frame has a pose.
        """
        kept = []
        self.left_out.add_all(trajectory.left_out, trajectory.name)
        for frame in self.frames:
            pose = trajectory.at(frame.stamp_ns) if frame.stamp_ns is not None else None
            if pose is not None:
                kept.append(replace(frame, session_from_camera=pose))
            else:
                self.left_out.add(frame.shown, "no pose near its time")
        if self.frames and not kept:
            stamps = [frame.stamp_ns / 1e9 for frame in self.frames if frame.stamp_ns is not None]
            first, last = trajectory.span_s
            raise RevisitError(
                f"{trajectory.name}: no pose at the time of any photograph: poses from {first:.3f} to {last:.3f} s, "
                f"photographs from {min(stamps):.3f} to {max(stamps):.3f} s; between poses more than "
                f"{MAX_GAP_NS / 1e9:g} s apart none is made up"
            )
        return replace(self, frames=kept, poses=told or f"those of {trajectory.name}").assuming(*trajectory.assumed)


def there(frames: list[Frame], left_out: LeftOut) -> list[Frame]:
    """Return the frames whose files are there."""
    found = {frame.path for frame in frames if frame.path.is_file()}
    for frame in frames:
        if frame.path not in found:
            left_out.add(frame.shown, "listed, but no such file")
    return [frame for frame in frames if frame.path in found]


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
