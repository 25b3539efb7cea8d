"""Pictures of a recording, as files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import cv2
import numpy as np

from ....errors import RevisitError
from ...camera import Calibration
from ...frames import Frame
from ...ids import plain_id
from ..source import too_near
from ..video import save
from .messages import Recording

IMAGE = "sensor_msgs/msg/Image"
COMPRESSED = "sensor_msgs/msg/CompressedImage"
# Each encoding's bytes a pixel, and its conversion to BGR.
ENCODINGS = {
    "bgr8": (3, None),
    "8UC3": (3, None),
    "rgb8": (3, cv2.COLOR_RGB2BGR),
    "bgra8": (4, cv2.COLOR_BGRA2BGR),
    "rgba8": (4, cv2.COLOR_RGBA2BGR),
    "mono8": (1, cv2.COLOR_GRAY2BGR),
    "8UC1": (1, cv2.COLOR_GRAY2BGR),
}
# Names of topics whose pictures are depths.
DEPTH_WORDS = ("depth", "disparity")


def picture_topic(recording: Recording, named: str | None) -> tuple[str, str]:
    """Return the topic of the pictures, and the frame that they are in."""
    topic = recording.one("image", named, (IMAGE, COMPRESSED), skip=DEPTH_WORDS)
    if topic is None:
        raise RevisitError(f"{recording.file}: no pictures in it ({IMAGE}, {COMPRESSED}); it has {recording.told()}")
    first = recording.first(topic)
    if first is None:
        raise RevisitError(f"{recording.file}: no picture on {topic}")
    return topic, first.header.frame_id


def frames_of(recording: Recording, topic: str, calibration: Calibration | None, every_s: float, work: Path) -> list[Frame]:
    """Return the pictures in order of time; they are kept in `work`."""
    file = recording.file
    frames: list[Frame] = []
    for number, (stamp_ns, message) in enumerate(recording.messages(topic)):
        if too_near(frames, stamp_ns, every_s):
            continue
        name = plain_id(f"{file.stem}-{number:06}")
        origin = f"{file}, picture {number} of {topic}"
        path = _save(message, work / f"{name}.jpg", origin)
        frames.append(Frame(name, path, file.stem, number, stamp_ns, calibration=calibration, origin=origin))
    return sorted(frames, key=lambda frame: frame.stamp_ns or 0)


def _save(message: Any, path: Path, origin: str) -> Path:
    if hasattr(message, "format"):
        # As it was compressed; readers look at the bytes, not at the name.
        path.write_bytes(bytes(message.data))
        return path
    if message.encoding not in ENCODINGS:
        raise RevisitError(f"{origin}: it is {message.encoding}; known: {', '.join(ENCODINGS)}")
    channels, conversion = ENCODINGS[message.encoding]
    rows = np.frombuffer(bytes(message.data), np.uint8).reshape(message.height, message.step)
    image = rows[:, : message.width * channels].reshape(message.height, message.width, channels)
    return save(image if conversion is None else cv2.cvtColor(image, conversion), path)
