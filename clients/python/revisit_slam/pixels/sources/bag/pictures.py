"""Pictures of a recording, as files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import cv2
import numpy as np

from ....errors import RevisitError
from ....imports.bag import Bag
from ....left_out import Unreadable
from ...camera import Calibration
from ...frames import Frame
from ...ids import plain_id
from ..source import too_near
from ..video import save

IMAGE = "sensor_msgs/msg/Image"
COMPRESSED = "sensor_msgs/msg/CompressedImage"
# Each encoding's numbers a pixel, and its conversion to BGR. Names of 16 bits instead of 8 are read as well.
ENCODINGS = {
    "bgr8": (3, None), "rgb8": (3, cv2.COLOR_RGB2BGR), "bgra8": (4, cv2.COLOR_BGRA2BGR), "rgba8": (4, cv2.COLOR_RGBA2BGR),
    "mono8": (1, cv2.COLOR_GRAY2BGR), "8UC1": (1, cv2.COLOR_GRAY2BGR), "8UC3": (3, None),
    "bayer_rggb8": (1, cv2.COLOR_BayerRGGB2BGR), "bayer_bggr8": (1, cv2.COLOR_BayerBGGR2BGR),
    "bayer_gbrg8": (1, cv2.COLOR_BayerGBRG2BGR), "bayer_grbg8": (1, cv2.COLOR_BayerGRBG2BGR),
    "yuv422": (2, cv2.COLOR_YUV2BGR_UYVY), "uyvy": (2, cv2.COLOR_YUV2BGR_UYVY),
    "yuv422_yuy2": (2, cv2.COLOR_YUV2BGR_YUY2), "yuyv": (2, cv2.COLOR_YUV2BGR_YUY2),
}  # fmt: skip
# Names of topics whose pictures are depths.
DEPTH_WORDS = ("depth", "disparity")


def picture_topic(recording: Bag, named: str | None) -> tuple[str, str]:
    """Return the topic of the pictures, and the frame that they are in."""
    topic = recording.one("--image-topic", named, (IMAGE, COMPRESSED), skip=DEPTH_WORDS)
    if topic is None:
        raise RevisitError(f"{recording.file}: no pictures in it ({IMAGE}, {COMPRESSED}); it has {recording.told()}")
    first = recording.first(topic)
    if first is None:
        raise RevisitError(f"{recording.file}: no picture on {topic}")
    return topic, first.header.frame_id


def frames_of(recording: Bag, topic: str, calibration: Calibration | None, every_s: float, work: Path) -> list[Frame]:
    """Return the pictures in order of time; they are kept in `work`."""
    file = recording.file
    frames: list[Frame] = []
    for number, (stamp_ns, message) in enumerate(recording.messages(topic)):
        if too_near(frames, stamp_ns, every_s):
            continue
        origin = f"{file}, picture {number} of {topic}"
        with recording.left_out.part():
            path, name = _save(message, work / f"{number:06}.jpg", origin), plain_id(f"{file.stem}-{number:06}")
            frames.append(Frame(name, path, file.stem, number, stamp_ns, calibration=calibration, origin=origin))
    return sorted(frames, key=lambda frame: frame.stamp_ns or 0)


def _save(message: Any, path: Path, origin: str) -> Path:
    if hasattr(message, "format"):
        # As it was compressed; readers look at the bytes, not at the name.
        path.write_bytes(bytes(message.data))
        return path
    wide = message.encoding.endswith("16")
    encoding = message.encoding[:-2] + "8" if wide else message.encoding
    if encoding not in ENCODINGS:
        raise Unreadable(origin, f"it is {message.encoding}; known: {', '.join(ENCODINGS)}, and those of 16 bits")
    channels, conversion = ENCODINGS[encoding]
    number = np.dtype("u1" if not wide else ">u2" if message.is_bigendian else "<u2")
    try:
        rows = np.frombuffer(bytes(message.data), number).reshape(message.height, message.step // number.itemsize)
        image = rows[:, : message.width * channels].reshape(message.height, message.width, channels)
        image = (image >> 8).astype(np.uint8) if wide else image
        image = image if conversion is None else cv2.cvtColor(image, conversion)
    except (ValueError, cv2.error) as error:
        size = f"{message.width} x {message.height} in rows of {message.step} bytes"
        raise Unreadable(origin, f"{len(message.data)} bytes are no picture of {size}") from error
    return save(image, path)
