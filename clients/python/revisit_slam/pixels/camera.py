"""Pinhole camera: given, or guessed from the size of the photographs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

# A lens of 27 mm on 36 mm of film, the main camera of most phones.
FOCAL_SHARE = 0.75


@dataclass(frozen=True)
class Camera:
    """Focal length, centre and size in pixels."""

    focal_px: float
    width: int
    height: int

    @staticmethod
    def of(image: np.ndarray, focal_px: float | None) -> Camera:
        """Return the camera of a photograph; without a focal length a common one is assumed."""
        height, width = image.shape[:2]
        return Camera(focal_px or FOCAL_SHARE * max(width, height), width, height)

    def body(self) -> dict[str, float]:
        """Return it as the API writes it."""
        return {
            "fx": self.focal_px,
            "fy": self.focal_px,
            "cx": self.width / 2,
            "cy": self.height / 2,
            "width": self.width,
            "height": self.height,
        }

    def bearings(self, pixels: np.ndarray) -> np.ndarray:
        """Return unit vectors to pixels (n x 2) in the camera frame: x right, y down, z forward."""
        rays = np.column_stack(
            (
                (pixels[:, 0] - self.width / 2) / self.focal_px,
                (pixels[:, 1] - self.height / 2) / self.focal_px,
                np.ones(len(pixels)),
            )
        )
        return rays / np.linalg.norm(rays, axis=1, keepdims=True)
