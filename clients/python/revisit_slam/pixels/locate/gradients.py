"""Gradient features: SIFT keypoints whose descriptors are made binary, so that a server compares them as it does ORB's.

In a building that repeats itself they tell places apart better than ORB does: they are found where ORB finds none, on
glass and bare walls, and where they agree with the wrong floor they agree in fewer parts of the picture.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import cv2
import numpy as np

from ..features import Features, working

MAX_FEATURES = 2000
WORKING_SIDE_PX = 960
# Half of OpenCV's default: indoor walls have little contrast.
MIN_CONTRAST = 0.02
# Diameter of the smallest keypoints that OpenCV finds, in pixels, and the scale of one octave as the API counts them.
SMALLEST_PX = 3.2
OCTAVE_FACTOR = 1.2
MAX_OCTAVE = 63
SAMPLED_OF_EACH = 200


@dataclass(frozen=True)
class Gradients:
    """Keypoints (n x 4: u, v in the photograph's own pixels, octave, angle in degrees) and descriptors (n x 128 of bytes)."""

    keypoints: np.ndarray
    descriptors: np.ndarray


def gradients_of(image: np.ndarray) -> Gradients:
    """Return the SIFT features of a photograph (BGR), strongest first."""
    grey, scale = working(image, WORKING_SIDE_PX)
    sift = cv2.SIFT_create(nfeatures=MAX_FEATURES, contrastThreshold=MIN_CONTRAST)
    found, descriptors = sift.detectAndCompute(grey, None)
    if descriptors is None:
        return Gradients(np.zeros((0, 4)), np.zeros((0, 128), np.uint8))
    rows = np.array([(p.pt[0] / scale, p.pt[1] / scale, _octave(p.size), p.angle % 360, p.response) for p in found])
    order = np.lexsort((rows[:, 0], rows[:, 1], -rows[:, 4]))[:MAX_FEATURES]
    return Gradients(rows[order, :4], descriptors[order].astype(np.uint8))


def _octave(size_px: float) -> int:
    return min(max(round(math.log(size_px / SMALLEST_PX, OCTAVE_FACTOR)), 0), MAX_OCTAVE)


class Binariser:
    """Makes 256 bits of a descriptor: whether each of its 128 numbers is above the lower and the upper third of the gallery's."""

    def __init__(self, gallery: Iterable[Gradients]) -> None:
        # Enough of each photograph for thirds, at even steps from the strongest to the weakest.
        steps = ((one.descriptors, -(-len(one.descriptors) // SAMPLED_OF_EACH)) for one in gallery)
        rows = [_rooted(descriptors[::step]) for descriptors, step in steps if step]
        every = np.concatenate(rows) if rows else np.zeros((1, 128), np.float32)
        self._thresholds = np.quantile(every, (1 / 3, 2 / 3), axis=0).astype(np.float32)

    def features(self, gradients: Gradients) -> Features:
        """Return features with binary descriptors."""
        rooted = _rooted(gradients.descriptors)
        bits = np.concatenate([rooted > threshold for threshold in self._thresholds], axis=1)
        return Features(gradients.keypoints, np.packbits(bits, axis=1))


def _rooted(descriptors: np.ndarray) -> np.ndarray:
    """Return RootSIFT (R. Arandjelovic, A. Zisserman, CVPR 2012): the roots of the shares of the sum."""
    numbers = descriptors.astype(np.float32)
    return np.sqrt(numbers / np.maximum(numbers.sum(axis=1, keepdims=True), 1.0))
