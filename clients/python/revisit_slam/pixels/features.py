"""ORB features of a photograph."""

from __future__ import annotations

import base64
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np

MAX_FEATURES = 1000
# Features are sought in a photograph of this longer side: words must not depend on the camera's resolution.
WORKING_SIDE_PX = 640


@dataclass(frozen=True)
class Features:
    """Keypoints (n x 4: u, v in the photograph's own pixels, octave, angle in degrees) and descriptors (n x 32)."""

    keypoints: np.ndarray
    descriptors: np.ndarray

    def __len__(self) -> int:
        return len(self.keypoints)

    def body(self, most: int | None = None) -> dict[str, Any]:
        """Return the first of them as the API takes them."""
        return {
            "descriptor_bytes": self.descriptors.shape[1],
            "descriptors": base64.b64encode(self.descriptors[:most].tobytes()).decode(),
            "keypoints": [[round(float(u), 2), round(float(v), 2), int(o), round(float(a), 1)] for u, v, o, a in self.keypoints[:most]],
        }


def features_of(image: np.ndarray, max_features: int = MAX_FEATURES, working_side_px: int = WORKING_SIDE_PX) -> Features:
    """Return the ORB features of a photograph (BGR), strongest first."""
    grey, scale = working(image, working_side_px)
    found, descriptors = cv2.ORB_create(nfeatures=max_features, fastThreshold=12).detectAndCompute(grey, None)
    if descriptors is None:
        return Features(np.zeros((0, 4)), np.zeros((0, 32), np.uint8))
    rows = np.array([(p.pt[0] / scale, p.pt[1] / scale, p.octave, p.angle, p.response) for p in found])
    # The detector's own order depends on its threads; ties are broken by place.
    order = np.lexsort((rows[:, 0], rows[:, 1], -rows[:, 4]))
    return Features(rows[order, :4], descriptors[order])


def working(image: np.ndarray, side_px: int) -> tuple[np.ndarray, float]:
    """Return a photograph (BGR) in grey with at most this longer side, and by what it was scaled."""
    height, width = image.shape[:2]
    scale = min(1.0, side_px / max(width, height))
    grey = cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)
    if scale < 1.0:
        grey = cv2.resize(grey, (round(width * scale), round(height * scale)), interpolation=cv2.INTER_AREA)
    return grey, scale
