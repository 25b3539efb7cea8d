"""Calibration of a topic's pictures, from its `CameraInfo`."""

from __future__ import annotations

from pathlib import PurePosixPath
from typing import Any

from ....errors import RevisitError
from ....imports.bag import Bag
from ...camera import Calibration

CAMERA_INFO = "sensor_msgs/msg/CameraInfo"
MODELS = ("plumb_bob", "rational_polynomial", "equidistant", "fisheye", "")
FISHEYE = ("equidistant", "fisheye")
# By convention the pictures of such a topic are undistorted.
RECTIFIED = "image_rect"


def calibration_of(recording: Bag, image_topic: str, camera_frame: str, named: str | None) -> Calibration | None:
    """Return the calibration of a topic's pictures; None where nothing tells it."""
    info = _camera_info(recording, image_topic, camera_frame, named)
    if info is None:
        return None
    k, d, p = (info.k, info.d, info.p) if hasattr(info, "k") else (info.K, info.D, info.P)
    rectified = RECTIFIED in image_topic
    fx, fy, cx, cy, terms = (p[0], p[5], p[2], p[6], ()) if rectified else (k[0], k[4], k[2], k[5], d)
    if fx == 0:  # ROS's own mark of a camera that is not calibrated.
        return None
    model = info.distortion_model
    if model not in MODELS:
        raise RevisitError(f"{recording.file}: distortion_model {model} is not known ({', '.join(filter(None, MODELS))})")
    numbers = (float(fx), float(fy), float(cx), float(cy), tuple(float(term) for term in terms))
    size = (info.width, info.height) if info.width and info.height else None
    where = f"{recording.file}, the camera of {image_topic}"
    return Calibration.read(where, *numbers, model in FISHEYE and not rectified, size)


def _camera_info(recording: Bag, image_topic: str, camera_frame: str, named: str | None) -> Any | None:
    """Return the camera that was named, the one beside the pictures, or one of their frame."""
    if named is not None:
        topic = recording.one("--camera-info-topic", named, (CAMERA_INFO,))
        return recording.first(topic) if topic is not None else None
    there = recording.topics(CAMERA_INFO)
    # By convention it stands beside the pictures: /camera/image_raw, /camera/image_raw/compressed.
    for parent in PurePosixPath(image_topic).parents:
        if str(parent / "camera_info") in there:
            return recording.first(str(parent / "camera_info"))
    infos = (recording.first(topic) for topic in there)
    return next((info for info in infos if info is not None and info.header.frame_id == camera_frame), None)
