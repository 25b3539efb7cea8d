"""Pinhole camera: calibrated, or guessed from the size of the photographs; and the distortion to take out of them."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from ..errors import RevisitError

# A lens of 27 mm on 36 mm of film, the main camera of most phones.
FOCAL_SHARE = 0.75


@dataclass(frozen=True)
class Camera:
    """Undistorted pinhole: focal lengths, centre and size in pixels."""

    fx: float
    fy: float
    cx: float
    cy: float
    width: int
    height: int

    @staticmethod
    def of(image: np.ndarray, focal_px: float | None) -> Camera:
        """Return the camera of a photograph; without a focal length a common one is assumed."""
        height, width = image.shape[:2]
        focal_px = focal_px or FOCAL_SHARE * max(width, height)
        return Camera(focal_px, focal_px, width / 2, height / 2, width, height)

    def body(self) -> dict[str, float]:
        """Return it as the API writes it."""
        return {
            "fx": self.fx,
            "fy": self.fy,
            "cx": self.cx,
            "cy": self.cy,
            "width": self.width,
            "height": self.height,
        }

    def rays(self, pixels: np.ndarray) -> np.ndarray:
        """Return vectors to pixels (n x 2) whose z is 1, in the camera frame: x right, y down, z forward."""
        return np.column_stack(
            ((pixels[:, 0] - self.cx) / self.fx, (pixels[:, 1] - self.cy) / self.fy, np.ones(len(pixels)))
        )

    def bearings(self, pixels: np.ndarray) -> np.ndarray:
        """Return unit vectors to pixels (n x 2) in the camera frame."""
        rays = self.rays(pixels)
        return rays / np.linalg.norm(rays, axis=1, keepdims=True)


@dataclass(frozen=True)
class Calibration:
    """A pinhole and its distortion, as OpenCV names them (k1, k2, p1, p2, k3 ..; `fisheye`: its four-term model).

    The undistorted picture keeps focal lengths, centre and size.
    """

    fx: float
    fy: float
    cx: float
    cy: float
    distortion: tuple[float, ...] = ()
    fisheye: bool = False
    size: tuple[int, int] | None = None
    """Width and height of the pictures that it is of, where that is known."""

    def camera(self, image: np.ndarray, name: object) -> Camera:
        """Return the camera of an undistorted picture; a picture of another size is an error that names it."""
        height, width = image.shape[:2]
        if self.size is not None and self.size != (width, height):
            raise RevisitError(f"{name}: {width} x {height} pixels, but the calibration is of {self.size[0]} x {self.size[1]}")
        return Camera(self.fx, self.fy, self.cx, self.cy, width, height)

    def undistorted(self, image: np.ndarray, interpolation: int = cv2.INTER_LINEAR) -> np.ndarray:
        """Return the picture that the pinhole alone would have taken."""
        if not any(self.distortion):
            return image
        matrix, size = self._matrix(), (image.shape[1], image.shape[0])
        maps = cv2.fisheye.initUndistortRectifyMap if self.fisheye else cv2.initUndistortRectifyMap
        columns, rows = maps(matrix, np.array(self.distortion), np.eye(3), matrix, size, cv2.CV_32FC1)
        return cv2.remap(image, columns, rows, interpolation, borderMode=cv2.BORDER_CONSTANT)

    def undistorted_pixels(self, pixels: np.ndarray) -> np.ndarray:
        """Return where pixels (n x 2) of the picture as taken lie in the undistorted one."""
        if not any(self.distortion) or not len(pixels):
            return pixels
        undistort = cv2.fisheye.undistortPoints if self.fisheye else cv2.undistortPoints
        points = np.asarray(pixels, float).reshape(-1, 1, 2)
        return undistort(points, self._matrix(), np.array(self.distortion), P=self._matrix()).reshape(-1, 2)

    def _matrix(self) -> np.ndarray:
        return np.array([[self.fx, 0.0, self.cx], [0.0, self.fy, self.cy], [0.0, 0.0, 1.0]])
