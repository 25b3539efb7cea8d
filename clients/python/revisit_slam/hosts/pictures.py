"""Pictures of `sensor_msgs/Image`, and the crops of what was detected in them."""

from __future__ import annotations

import base64
from typing import Any

import numpy as np

from ..errors import RevisitError
from .png import png

# Of each encoding its channels, and which of them are red, green and blue.
ENCODINGS: dict[str, tuple[int, list[int] | None]] = {
    "rgb8": (3, [0, 1, 2]),
    "bgr8": (3, [2, 1, 0]),
    "rgba8": (4, [0, 1, 2]),
    "bgra8": (4, [2, 1, 0]),
    "mono8": (1, None),
    "8UC1": (1, None),
}
# Depth images have millimetres as whole numbers, or metres.
DEPTHS: dict[str, tuple[np.dtype[Any], float]] = {
    "16UC1": (np.dtype("<u2"), 1e-3),
    "mono16": (np.dtype("<u2"), 1e-3),
    "32FC1": (np.dtype("<f4"), 1.0),
}
# A sign is read as well from a smaller picture.
MAX_CROP_PX = 320
MIN_CROP_PX = 2


def picture_of(message: Any) -> np.ndarray:
    """Return an `Image` as rows of red, green, blue, or of grey."""
    if message.encoding not in ENCODINGS:
        raise RevisitError(f"a picture is {message.encoding}; known: {', '.join(ENCODINGS)}")
    channels, order = ENCODINGS[message.encoding]
    rows = _rows(message, channels)
    return rows if order is None else rows.reshape(len(rows), -1, channels)[:, :, order]


def depth_of(message: Any) -> np.ndarray:
    """Return a depth image in metres; 0 where nothing was measured."""
    if message.encoding not in DEPTHS:
        raise RevisitError(f"a depth image is {message.encoding}; known: {', '.join(DEPTHS)}")
    dtype, metres_per_unit = DEPTHS[message.encoding]
    depth_m = np.ascontiguousarray(_rows(message, dtype.itemsize)).view(dtype).astype(float) * metres_per_unit
    return np.where(np.isfinite(depth_m) & (depth_m > 0), depth_m, 0.0)


def _rows(message: Any, bytes_a_pixel: int) -> np.ndarray:
    """Return the bytes of a picture, row by row, without what pads a row."""
    height, width, step = int(message.height), int(message.width), int(message.step)
    data = np.frombuffer(bytes(message.data), np.uint8)
    if step < width * bytes_a_pixel or len(data) < height * step:
        raise RevisitError(f"a picture of {width} x {height} has {len(data)} bytes in rows of {step}")
    return data[: height * step].reshape(height, step)[:, : width * bytes_a_pixel]


def crop(picture: np.ndarray, box: list[float]) -> str | None:
    """Return what a box shows, as a PNG in base64; None where it shows nothing."""
    height, width = picture.shape[:2]
    x0, y0 = max(int(box[0]), 0), max(int(box[1]), 0)
    x1, y1 = min(int(np.ceil(box[2])), width), min(int(np.ceil(box[3])), height)
    if x1 - x0 < MIN_CROP_PX or y1 - y0 < MIN_CROP_PX:
        return None
    every = -(-max(x1 - x0, y1 - y0) // MAX_CROP_PX)
    return base64.b64encode(png(picture[y0:y1:every, x0:x1:every])).decode()
