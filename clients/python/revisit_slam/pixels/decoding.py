"""Decoding: what a picture's file shows, or why it shows nothing."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import cv2
import numpy as np

from ..files import FIRST_BYTES, what_is
from ..left_out import Unreadable

HEIC = "a HEIC or AVIF picture"
HEIC_NEEDS = "install revisit-slam[heic], which reads HEIC"


def read_bytes(path: Path, name: object) -> bytes:
    """Return a file's bytes; `name` is what a person knows it by."""
    try:
        return path.read_bytes()
    except OSError as error:
        raise Unreadable(name, f"cannot be read: {error.strerror}") from error


def decoded(data: bytes, flags: int, name: object) -> np.ndarray:
    """Return the pixels of a picture's bytes, by OpenCV's flags.

    Raises:
        Unreadable: They are no picture, or only a part of one.
    """
    told = what_is(data[:FIRST_BYTES])
    image = cv2.imdecode(np.frombuffer(data, np.uint8), flags) if data else None
    if image is None and told == HEIC:
        image = _heic(data)
    if image is None and told == HEIC and pillow_heif() is None:
        raise Unreadable(name, f"{HEIC}: {HEIC_NEEDS}")
    if image is None and not told.endswith("picture"):
        raise Unreadable(name, f"not a picture that OpenCV reads: it is {told or 'of no known form'}")
    if image is None or _is_cut(data):
        raise Unreadable(name, f"{told}, damaged or cut short")
    return image


def pillow_heif() -> Any | None:
    """Return the package that reads HEIC, where it is installed."""
    try:
        import pillow_heif
    except ImportError:
        return None
    return pillow_heif


def _heic(data: bytes) -> np.ndarray | None:
    """Return the pixels as a person sees them: whoever decodes HEIC turns them."""
    try:
        return np.array(pillow_heif().read_heif(data).to_pillow().convert("RGB"))[:, :, ::-1].copy()
    except Exception:  # It raises whatever a damaged file leads to.
        return None


def _is_cut(data: bytes) -> bool:
    """Whether a JPEG has no end, of which some versions of OpenCV paint grey what is missing."""
    at = 2
    # A smaller picture with an end of its own may stand before the first scan.
    while data[:3] == b"\xff\xd8\xff" and data[at : at + 1] == b"\xff" and data[at + 1 : at + 2] != b"\xda":
        at += 2 + int.from_bytes(data[at + 2 : at + 4], "big")
    return data[:3] == b"\xff\xd8\xff" and data.find(b"\xff\xd9", at) < 0
