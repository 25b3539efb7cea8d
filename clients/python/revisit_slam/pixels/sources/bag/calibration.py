"""Calibration of a topic's pictures, from its `CameraInfo`."""

from __future__ import annotations

from typing import Any

from ....errors import RevisitError
from ...camera import Calibration
from .messages import Recording

CAMERA_INFO = "sensor_msgs/msg/CameraInfo"
MODELS = ("plumb_bob", "rational_polynomial", "equidistant", "fisheye", "")
FISHEYE = ("equidistant", "fisheye")
# By convention the pictures of such a topic are undistorted.
RECTIFIED = "image_rect"


def calibration_of(recording: Recording, image_topic: str, camera_frame: str, named: str | None) -> Calibration | None:
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


def _camera_info(recording: Recording, image_topic: str, camera_frame: str, named: str | None) -> Any | None:
    """Return the camera that was named, the one beside the pictures, or one of their frame."""
    if named is not None:
        topic = recording.one("camera-info", named, (CAMERA_INFO,))
        return recording.first(topic) if topic is not None else None
    there = recording.topics(CAMERA_INFO)
    # By convention it stands beside the pictures: /camera/image_raw, /camera/image_raw/compressed.
    beside = [topic for topic in (f"{parent}/camera_info" for parent in _parents(image_topic)) if topic in there]
    if beside:
        return recording.first(beside[0])
    infos = (recording.first(topic) for topic in there)
    return next((info for info in infos if info is not None and info.header.frame_id == camera_frame), None)


def _parents(topic: str) -> list[str]:
    """Return the names above a topic's, the nearest first."""
    parts = topic.split("/")
    return ["/".join(parts[:length]) for length in range(len(parts) - 1, 0, -1)]
