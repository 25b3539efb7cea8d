"""Images: a folder of photographs."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

from ...errors import RevisitError
from ..camera import Calibration
from ..frames import list_frames
from ..trajectory import Trajectory, nanoseconds
from .source import Source, posed

# From here on a whole number is a time in nanoseconds.
NANOSECONDS_DIGITS = 16


def open_images(folder: Path, calibration: Calibration | None, trajectory: Trajectory | None) -> Source:
    """Open a folder; with a trajectory the files' names are their times, in seconds or in nanoseconds."""
    frames = [replace(frame, calibration=calibration) for frame in list_frames(folder)]
    if trajectory is None:
        return Source(frames, str(folder))
    frames = [replace(frame, stamp_ns=time_of(frame.path), video=str(frame.path.parent.name)) for frame in frames]
    frames, notes = posed(sorted(frames, key=lambda frame: frame.stamp_ns or 0), trajectory)
    frames = [replace(frame, number=number) for number, frame in enumerate(frames, 1)]
    return Source(frames, str(folder), f"those of {trajectory.name}", notes=notes)


def time_of(path: Path) -> int:
    """Return the time in nanoseconds that a file is named by."""
    if not re.fullmatch(r"\d+(\.\d+)?", path.stem):
        raise RevisitError(f"{path}: with --trajectory a photograph's name is its time, in seconds or in nanoseconds")
    if "." not in path.stem and len(path.stem) >= NANOSECONDS_DIGITS:
        return int(path.stem)
    return nanoseconds(path.stem)
