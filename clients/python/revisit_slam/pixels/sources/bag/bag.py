"""Bag: what a recording has becomes a source."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

from ....errors import RevisitError
from ....imports.damage import told_of
from ...camera import Calibration
from ...trajectory import Trajectory
from ....needed import needed
from ..source import ROTATIONS, Source
from .calibration import calibration_of
from .messages import Recording
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
    highlevel, typesys = needed("rosbags.highlevel", "rosbags"), needed("rosbags.typesys", "rosbags")
    store = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE)
    # Recordings carry their messages' definitions, or have the standard ones.
    with told_of(file, "rosbags"), highlevel.AnyReader(_files(file), default_typestore=store) as reader:
        source = Source([], str(file))
        recording = Recording(file, reader, source.left_out)
        topic, camera_frame = picture_topic(recording, topics["image"])
        calibration = calibration or calibration_of(recording, topic, camera_frame, topics["camera_info"])
        source = replace(source, frames=frames_of(recording, topic, calibration, every_s, work))
        if trajectory is not None:
            return source.along(trajectory)
        trajectory, why = odometry_of(recording, topics["odometry"], camera_frame)
        if trajectory is None:
            return replace(source, poses=f"{ROTATIONS} ({why})")
        return source.along(trajectory, f"odometry on {why}")


def _files(path: Path) -> list[Path]:
    """Return what to open: a file, a folder that describes itself, or the pieces of one recording in a folder that does not."""
    if path.is_file() or (path / "metadata.yaml").exists():
        return [path]
    found = sorted(file for file in path.iterdir() if file.suffix in SUFFIXES and not file.name.startswith("."))
    if len({re.sub(r"_\d+$", "", file.stem) for file in found}) == 1:
        return found
    several = f"several recordings and no metadata.yaml; name one: {', '.join(file.name for file in found)}"
    raise RevisitError(f"{path}: {several if found else NOTHING}")
