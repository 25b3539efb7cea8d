"""Images: a folder of photographs."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from ..camera import Calibration
from ..frames import list_frames
from ..stamps import named_time_ns
from ..trajectory import Trajectory
from .source import Source

# How files must be named where a trajectory tells their poses.
NAMED = "with --trajectory a photograph's name is its time, in seconds, or in milli-, micro- or nanoseconds since 1970"


def open_images(folder: Path, calibration: Calibration | None, trajectory: Trajectory | None) -> Source:
    """Open a folder; with a trajectory the files' names are their times."""
    source = Source([], str(folder))
    frames = [replace(frame, calibration=calibration) for frame in list_frames(folder, source.left_out)]
    if trajectory is None:
        return replace(source, frames=frames)
    frames = [replace(frame, stamp_ns=named_time_ns(frame.path.stem), video=frame.path.parent.name) for frame in frames]
    for frame in frames:
        if frame.stamp_ns is None:
            source.left_out.add(frame.shown, NAMED)
    frames = sorted((frame for frame in frames if frame.stamp_ns is not None), key=lambda frame: frame.stamp_ns or 0)
    frames = [replace(frame, number=number) for number, frame in enumerate(frames, 1)]
    return replace(source, frames=frames).along(trajectory)
