"""Ranges: how far what a photograph shows is, by a depth image or by triangulated points; else by a guess that says so."""

from __future__ import annotations

import numpy as np

from .frames import Frame
from .pinhole import Pinhole

# Letters of this height are assumed where nothing measures a distance; the server compares bearings only. What the
# guess still decides is which sightings are one sign: the server joins those within 0.75 m, here two and a half heights
# of a letter, which is nearer than two signs hang.
LETTER_HEIGHT_M = 0.3
# So many pixels of a box, and this share of it, need a depth: sensors see nothing on glass and metal.
MIN_DEPTH_PX = 12
MIN_DEPTH_SHARE = 0.25
# A plate is plain within; points on its rim count, half its height around it.
LANDMARK_MARGIN = 0.5
MIN_LANDMARKS = 3
# Depths of a flat sign spread little; where the middle half of them does, some lie on another surface.
MAX_QUARTILE_RATIO = 1.3


class Ranges:
    """Depths within one photograph, in the session's unit."""

    def __init__(self, frame: Frame, camera: Pinhole, letter_height_m: float, depths_m: np.ndarray | None = None) -> None:
        self._camera = camera
        self._letter_height_m = letter_height_m
        self._image = depths_m
        self._pixels, self._depths = np.zeros((0, 2)), np.zeros(0)
        if frame.landmarks is not None and frame.session_from_camera is not None and len(frame.landmarks.ids):
            camera_from_session = np.linalg.inv(frame.session_from_camera)
            depths = frame.landmarks.positions @ camera_from_session[2, :3] + camera_from_session[2, 3]
            ahead = depths > 0
            self._pixels, self._depths = frame.landmarks.pixels[ahead], depths[ahead]

    def measured(self, box: tuple[float, float, float, float]) -> float | None:
        """Return the depth along the optical axis of what fills a box (x0, y0, x1, y1), if it was measured."""
        x0, y0, x1, y1 = box
        if self._image is not None:
            height, width = self._image.shape
            part = self._image[max(int(y0), 0) : min(int(y1) + 1, height), max(int(x0), 0) : min(int(x1) + 1, width)]
            seen = part[part > 0]
            return _flat(seen) if len(seen) >= max(MIN_DEPTH_PX, MIN_DEPTH_SHARE * part.size) else None
        margin = LANDMARK_MARGIN * min(x1 - x0, y1 - y0)
        x, y = self._pixels[:, 0], self._pixels[:, 1]
        inside = (x >= x0 - margin) & (x <= x1 + margin) & (y >= y0 - margin) & (y <= y1 + margin)
        return _flat(self._depths[inside]) if inside.sum() >= MIN_LANDMARKS else None

    def guessed(self, letters_px: float) -> float:
        """Return a distance along the ray that nothing measured."""
        if len(self._depths):
            # A model without a known unit has no letters of any height; the scene is as far as it is at the median.
            return float(np.median(self._depths))
        return self._camera.fx * self._letter_height_m / letters_px

    def points(self, pixels: np.ndarray) -> np.ndarray:
        """Return camera-frame points (n x 3) at pixels of the depth image; NaN where there is no depth."""
        return np.full((len(pixels), 3), np.nan) if self._image is None else points_at(pixels, self._camera, self._image)


def points_at(pixels: np.ndarray, camera: Pinhole, depths_m: np.ndarray) -> np.ndarray:
    """Return camera-frame points (n x 3) at pixels (n x 2) of a depth image; NaN where there is no depth."""
    height, width = depths_m.shape
    column, row = np.round(pixels).astype(int).T
    inside = (column >= 0) & (column < width) & (row >= 0) & (row < height)
    depths = np.zeros(len(pixels))
    depths[inside] = depths_m[row[inside], column[inside]]
    return np.where(depths[:, None] > 0, camera.rays(pixels) * depths[:, None], np.nan)


def _flat(depths: np.ndarray) -> float | None:
    low, middle, high = np.percentile(depths, (25, 50, 75))
    return float(middle) if high <= MAX_QUARTILE_RATIO * low else None
