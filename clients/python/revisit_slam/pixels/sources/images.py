"""Images: a folder of photographs."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from ...left_out import LeftOut, Unreadable
from ..camera import Calibration
from ..frames import list_frames
from ..stamps import named_time_ns
from ..trajectory import Trajectory
from .source import Source


def open_images(folder: Path, calibration: Calibration | None, trajectory: Trajectory | None) -> Source:
    """Open a folder; with a trajectory the files' names are their times, in seconds or in nanoseconds."""
    left_out = LeftOut()
    frames = [replace(frame, calibration=calibration) for frame in list_frames(folder, left_out)]
    source = Source(frames, str(folder), left_out=left_out)
    if trajectory is None:
        return source
    timed = []
    for frame in frames:
        try:
            timed.append(replace(frame, stamp_ns=time_of(frame.path), video=str(frame.path.parent.name)))
        except Unreadable as error:
            left_out.add(error.name, error.why)
    timed.sort(key=lambda frame: frame.stamp_ns or 0)
    frames = [replace(frame, number=number) for number, frame in enumerate(timed, 1)]
    return replace(source, frames=frames).along(trajectory)


def time_of(path: Path) -> int:
    """Return the time in nanoseconds that a file is named by."""
    stamp_ns = named_time_ns(path.stem)
    if stamp_ns is None:
        why = "with --trajectory a photograph's name is its time, in seconds, or in milli-, micro- or nanoseconds since 1970"
        raise Unreadable(path, why)
    return stamp_ns
