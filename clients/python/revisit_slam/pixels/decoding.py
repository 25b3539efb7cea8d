"""Decoding: what a picture's file shows, or why it shows nothing."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np

from ..files import FIRST_BYTES, what_is
from ..left_out import Unreadable

JPEG, JPEG_END = b"\xff\xd8", b"\xff\xd9"
# Features are not found in smaller or narrower pictures.
MIN_SIDE_PX, MIN_SIDE_SHARE = 8, 0.01


def read_bytes(path: Path, name: object) -> bytes:
    """Return a file's bytes; `name` is what a person knows it by."""
    try:
        return path.read_bytes()
    except OSError as error:
        raise Unreadable(name, f"cannot be read: {error.strerror}") from error


def decoded(data: bytes, flags: int, name: object) -> np.ndarray:
    """Return the pixels of a picture's bytes, by OpenCV's flags; what is no whole picture is unreadable."""
    told = what_is(data[:FIRST_BYTES])
    image = cv2.imdecode(np.frombuffer(data, np.uint8), flags) if data else None
    # Of a JPEG without an end some versions of OpenCV paint grey what is missing.
    if image is not None and not (data.startswith(JPEG) and JPEG_END not in data[len(data) // 2 :]):
        height, width = image.shape[:2]
        if min(width, height) < max(MIN_SIDE_PX, max(width, height) * MIN_SIDE_SHARE):
            raise Unreadable(name, f"{width} x {height} pixels, which show nothing")
        return image
    if "HEIC" in told:
        return _heic(data, name)
    damaged = ", damaged or cut short" if told.endswith("picture") else ""
    raise Unreadable(name, f"not a picture that OpenCV reads: it is {told or 'of no known form'}{damaged}")


def _heic(data: bytes, name: object) -> np.ndarray:
    """Return the pixels as a person sees them: whoever decodes HEIC turns them."""
    try:
        import pillow_heif

        return np.array(pillow_heif.read_heif(data).to_pillow().convert("RGB"))[:, :, ::-1].copy()
    except ImportError as error:
        raise Unreadable(name, "a HEIC picture: install revisit-slam[heic], which reads it") from error
    except Exception as error:  # It raises whatever a damaged file leads to.
        raise Unreadable(name, "a HEIC or AVIF picture that pillow-heif does not read") from error
