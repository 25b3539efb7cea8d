"""Bag: a ROS 2 recording (MCAP or SQLite), or a ROS 1 bag: pictures, their camera, and odometry."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

from ....errors import RevisitError
from ....imports.bag import opened_bag
from ....imports.rtabmap.definitions import typestore
from ...camera import Calibration
from ...trajectory import Trajectory
from ..source import ROTATIONS, Source
from .calibration import calibration_of
from .odometry import odometry_of
from .pictures import frames_of, picture_topic

SUFFIXES = (".mcap", ".db3", ".bag")
NOTHING = f"no recording in it (metadata.yaml, {', '.join(SUFFIXES)})"
# Topics that a person may name; None: the only one.
Topics = dict[str, str | None]


def open_bag(
    file: Path, topics: Topics, calibration: Calibration | None, trajectory: Trajectory | None, every_s: float, work: Path
) -> Source:
    """Open a recording; its pictures are kept in `work`. A trajectory given is the camera's."""
    if not file.exists():
        raise RevisitError(f"{file}: no such file")
    source = Source([], str(file))
    with opened_bag(file, _pieces(file), typestore(), source.left_out) as recording:
        topic, camera_frame = picture_topic(recording, topics["image"])
        calibration = calibration or calibration_of(recording, topic, camera_frame, topics["camera_info"])
        source = replace(source, frames=frames_of(recording, topic, calibration, every_s, work))
        if trajectory is not None:
            return source.along(trajectory)
        trajectory, why = odometry_of(recording, topics["odometry"], camera_frame)
        if trajectory is None:
            return replace(source, poses=f"{ROTATIONS} ({why})")
        return source.along(trajectory, f"odometry on {why}")


def _pieces(path: Path) -> list[Path]:
    """Return what to open: a file, a folder that describes itself, or the pieces of one recording in a folder that does not."""
    if path.is_file() or (path / "metadata.yaml").exists():
        return [path]
    found = sorted(file for file in path.iterdir() if file.suffix in SUFFIXES and not file.name.startswith("."))
    if len({re.sub(r"_\d+$", "", file.stem) for file in found}) == 1:
        return found
    several = f"several recordings and no metadata.yaml; name one: {', '.join(file.name for file in found)}"
    raise RevisitError(f"{path}: {several if found else NOTHING}")
