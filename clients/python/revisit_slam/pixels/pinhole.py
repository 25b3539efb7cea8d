"""Pinhole: an undistorted camera."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..errors import RevisitError

# A lens of 27 mm on 36 mm of film, the main camera of most phones.
FOCAL_SHARE = 0.75
# What the server takes.
MAX_PIXEL = 1e6


@dataclass(frozen=True)
class Pinhole:
    """An undistorted camera: focal lengths, centre and size in pixels, counted from the middle of the first pixel."""

    fx: float
    fy: float
    cx: float
    cy: float
    width: int
    height: int

    @staticmethod
    def of(image: np.ndarray, focal_px: float | None) -> Pinhole:
        """Return the camera of a photograph; without a focal length a common one is assumed."""
        height, width = image.shape[:2]
        focal_px = focal_px or FOCAL_SHARE * max(width, height)
        return Pinhole(focal_px, focal_px, width / 2, height / 2, width, height)

    def checked(self, where: str) -> Pinhole:
        """Return it, or say what is wrong with it."""
        lengths = all(1e-3 <= length <= MAX_PIXEL for length in (self.fx, self.fy))
        sizes = all(0 < size <= MAX_PIXEL for size in (self.width, self.height))
        if not lengths or not sizes or not all(abs(centre) <= MAX_PIXEL for centre in (self.cx, self.cy)):
            raise RevisitError(f"{where}: no camera: {self.width} x {self.height}, focal lengths {self.fx:g}, {self.fy:g}")
        return self

    def body(self) -> dict[str, float]:
        """Return it as the API takes it."""
        return dict(vars(self))

    def rays(self, pixels: np.ndarray) -> np.ndarray:
        """Return vectors to pixels (n x 2) whose z is 1, in the camera frame: x right, y down, z forward."""
        return np.column_stack(
            ((pixels[:, 0] - self.cx) / self.fx, (pixels[:, 1] - self.cy) / self.fy, np.ones(len(pixels)))
        )

    def bearings(self, pixels: np.ndarray) -> np.ndarray:
        """Return unit vectors to pixels (n x 2) in the camera frame."""
        rays = self.rays(pixels)
        return rays / np.linalg.norm(rays, axis=1, keepdims=True)
