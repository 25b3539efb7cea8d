"""Source: photographs in order, with what is measured and what is guessed."""

from __future__ import annotations

from dataclasses import dataclass, replace

from ...errors import RevisitError
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
    notes: tuple[str, ...] = ()
    """What a person should know of what was left out."""

    def along(self, trajectory: Trajectory, told: str | None = None) -> Source:
        """Return it with the poses of a trajectory; frames that have none are left out, with a note.

        Raises:
            RevisitError: No frame has a pose.
        """
        kept = []
        for frame in self.frames:
            pose = trajectory.at(frame.stamp_ns) if frame.stamp_ns is not None else None
            if pose is not None:
                kept.append(replace(frame, session_from_camera=pose))
        if not kept:
            stamps = [frame.stamp_ns / 1e9 for frame in self.frames if frame.stamp_ns is not None]
            first, last = trajectory.span_s
            raise RevisitError(
                f"{trajectory.name}: no pose at the time of any photograph: poses from {first:.3f} to {last:.3f} s, "
                f"photographs from {min(stamps):.3f} to {max(stamps):.3f} s; between poses more than "
                f"{MAX_GAP_NS / 1e9:g} s apart none is made up"
            )
        notes, left_out = self.notes, len(self.frames) - len(kept)
        if left_out:
            notes += (f"{left_out} of {len(self.frames)} photographs have no pose near their time and are left out",)
        return replace(self, frames=kept, poses=told or f"those of {trajectory.name}", notes=notes)


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
