"""Distortions: synthetic changes of a photograph that asks, the same for every photograph and every run."""

from __future__ import annotations

from collections.abc import Callable

import cv2
import numpy as np

# Light: darker, with less contrast, as with the lamps off; and brighter, with the bright parts washed out.
DIM_GAMMA, DIM_GAIN = 1.6, 0.55
BRIGHT_GAMMA, BRIGHT_GAIN = 0.7, 1.15
# Standard deviation of the blur and side of the crop, as shares of the longer side and of each side.
BLUR_SHARE = 1 / 400
CROP_SHARE = 0.75


def _lit(gamma: float, gain: float) -> Callable[[np.ndarray], np.ndarray]:
    levels = np.clip(255 * gain * (np.arange(256) / 255) ** gamma, 0, 255).round().astype(np.uint8)
    return lambda image: cv2.LUT(image, levels)


def _blurred(image: np.ndarray) -> np.ndarray:
    return cv2.GaussianBlur(image, (0, 0), BLUR_SHARE * max(image.shape[:2]))


def _cropped(image: np.ndarray) -> np.ndarray:
    """Return the middle of the photograph, in its own pixels: a camera of the same focal length that sees less."""
    height, width = image.shape[:2]
    top, left = (round(side * (1 - CROP_SHARE) / 2) for side in (height, width))
    return np.ascontiguousarray(image[top : height - top, left : width - left])


DISTORTIONS: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "dim": _lit(DIM_GAMMA, DIM_GAIN),
    "bright": _lit(BRIGHT_GAMMA, BRIGHT_GAIN),
    "blur": _blurred,
    "crop": _cropped,
}
