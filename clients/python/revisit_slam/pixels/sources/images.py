"""Images: a folder of photographs."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

from ...errors import RevisitError
from ..camera import Calibration
from ..frames import list_frames
from ..trajectory import Trajectory, nanoseconds
from .source import Source

# Nanoseconds in the unit of a whole number, by its digits: seconds, milli-, micro- and nanoseconds since 1970.
UNITS = {10: 1_000_000_000, 13: 1_000_000, 16: 1_000, 19: 1}


def open_images(folder: Path, calibration: Calibration | None, trajectory: Trajectory | None) -> Source:
    """Open a folder; with a trajectory the files' names are their times, in seconds or in nanoseconds."""
    frames = [replace(frame, calibration=calibration) for frame in list_frames(folder)]
    if trajectory is None:
        return Source(frames, str(folder))
    frames = [replace(frame, stamp_ns=time_of(frame.path), video=str(frame.path.parent.name)) for frame in frames]
    frames.sort(key=lambda frame: frame.stamp_ns or 0)
    frames = [replace(frame, number=number) for number, frame in enumerate(frames, 1)]
    return Source(frames, str(folder)).along(trajectory)


def time_of(path: Path) -> int:
    """Return the time in nanoseconds that a file is named by."""
    if re.fullmatch(r"\d{1,11}\.\d+|\d{1,9}", path.stem):
        return nanoseconds(path.stem)
    unit = UNITS.get(len(path.stem)) if path.stem.isascii() and path.stem.isdigit() else None
    if unit is None:
        raise RevisitError(
            f"{path}: with --trajectory a photograph's name is its time, in seconds, or in milli-, micro- or nanoseconds since 1970"
        )
    return int(path.stem) * unit
