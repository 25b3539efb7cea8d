"""Landmarks of RTAB-Map: tags that a node saw, by the links to them; they become detections."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...pixels.pinhole import Pinhole
from ..poses import inverse, moved

# A link from a node to a landmark, whose number is negative there.
LANDMARK = 8
CLASS = "landmark"
# Links do not tell how large a tag is; only its box in the picture depends on it.
ASSUMED_SIDE_M = 0.16
NEAREST_M = 0.05


def detections_of(
    seen: list[tuple[int, np.ndarray]], map_from_base: np.ndarray, base_from_camera: np.ndarray, camera: Pinhole | None
) -> list[dict[str, Any]]:
    """Return the landmarks (number, `base_from_landmark`) in front of a camera as detections of the API."""
    if camera is None:
        return []
    found = []
    for number, base_from_landmark in seen:
        in_base = base_from_landmark[:3, 3]
        x, y, z = moved(inverse(base_from_camera), in_base[None])[0]
        if not z > NEAREST_M:
            continue
        u, v = camera.fx * x / z + camera.cx, camera.fy * y / z + camera.cy
        half = ASSUMED_SIDE_M / 2 * camera.fx / z
        found.append(
            {
                "class": CLASS,
                "confidence": 1.0,
                "box": [float(value) for value in (u - half, v - half, u + half, v + half)],
                "position": [float(value) for value in moved(map_from_base, in_base[None])[0]],
                "text": str(abs(number)),
            }
        )
    return found
