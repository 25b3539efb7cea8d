"""Bag: what a recording has becomes a source."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from ....errors import RevisitError
from ...camera import Calibration
from ...trajectory import Trajectory
from ....needed import needed
from ..source import ROTATIONS, Source
from .calibration import CAMERA_INFO, calibration_of
from .messages import Recording
from .odometry import odometry_of
from .pictures import frames_of, picture_topic


@dataclass(frozen=True)
class Topics:
    """Topics that a person named; None: the one that there is."""

    image: str | None = None
    camera_info: str | None = None
    odometry: str | None = None


def open_bag(
    file: Path, topics: Topics, calibration: Calibration | None, trajectory: Trajectory | None, every_s: float, work: Path
) -> Source:
    """Open a recording; its pictures are kept in `work`. A trajectory given is the camera's."""
    if not file.exists():
        raise RevisitError(f"{file}: no such file")
    highlevel, typesys = needed("rosbags.highlevel", "rosbags"), needed("rosbags.typesys", "rosbags")
    store = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE)
    try:
        # Recordings carry their messages' definitions, or have the standard ones.
        with highlevel.AnyReader([file], default_typestore=store) as reader:
            return _source(Recording(file, reader), topics, calibration, trajectory, every_s, work)
    except RevisitError:
        raise
    except Exception as error:  # It raises types of its own, and whatever a damaged file leads to.
        raise RevisitError(f"{file}: rosbags cannot read it: {(str(error) or type(error).__name__).splitlines()[0]}") from error


def _source(
    recording: Recording,
    topics: Topics,
    calibration: Calibration | None,
    trajectory: Trajectory | None,
    every_s: float,
    work: Path,
) -> Source:
    topic, camera_frame = picture_topic(recording, topics.image)
    calibration = calibration or calibration_of(recording, topic, camera_frame, topics.camera_info)
    frames = frames_of(recording, topic, calibration, every_s, work)
    notes: tuple[str, ...] = ()
    if calibration is None:
        notes = (f"no {CAMERA_INFO} for {topic}: a common focal length is assumed",)
    source = Source(frames, str(recording.file), notes=notes)
    if trajectory is not None:
        return source.along(trajectory)
    trajectory, why = odometry_of(recording, topics.odometry, camera_frame)
    if trajectory is None:
        return replace(source, notes=(*notes, f"{why}: poses are {ROTATIONS}"))
    return source.along(trajectory, f"odometry on {why}")
