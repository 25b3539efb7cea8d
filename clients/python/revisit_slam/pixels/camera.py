"""Calibration: a pinhole, and the distortion to take out of its photographs."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np

from ..errors import RevisitError
from ..left_out import Unreadable
from .pinhole import Pinhole

# How many terms of distortion OpenCV takes; its fisheye model has four.
TERMS = (0, 4, 5, 8, 12, 14)
FISHEYE_TERMS = 4


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

    @staticmethod
    def read(where: object, *values: Any, **more: Any) -> Calibration:
        """Make a calibration of what a file says; `where` is named if it is none."""
        try:
            return Calibration(*values, **more)
        except ValueError as error:
            raise RevisitError(f"{where}: {error}") from error

    def __post_init__(self) -> None:
        """Refuse what is no camera.

        Raises:
            ValueError: A focal length that is not above 0, a number that is none, or terms that OpenCV does not take.
        """
        if not all(math.isfinite(number) for number in (self.fx, self.fy, self.cx, self.cy, *self.distortion)):
            raise ValueError("a camera whose numbers are not all finite")
        if min(self.fx, self.fy) <= 0:
            raise ValueError(f"a camera of focal length {min(self.fx, self.fy):g}: it is not calibrated")
        if len(self.distortion) not in ((0, FISHEYE_TERMS) if self.fisheye else TERMS):
            taken = f"0 or {FISHEYE_TERMS}" if self.fisheye else ", ".join(map(str, TERMS))
            raise ValueError(f"{len(self.distortion)} terms of distortion; taken are {taken}")

    @property
    def distorts(self) -> bool:
        """Whether the pinhole alone would take another picture; a fisheye lens without any terms bends too."""
        return self.fisheye or any(self.distortion)

    def camera(self, image: np.ndarray, name: object) -> Pinhole:
        """Return the camera of an undistorted picture; one that is none of that picture is an error that names it."""
        height, width = image.shape[:2]
        if not (0 <= self.cx <= width and 0 <= self.cy <= height):
            raise Unreadable(name, f"{width} x {height} pixels, but the camera's centre is at {self.cx:g}, {self.cy:g}")
        if self.size is not None and self.size != (width, height):
            raise Unreadable(name, f"{width} x {height} pixels, but the calibration is of {self.size[0]} x {self.size[1]}")
        return Pinhole(self.fx, self.fy, self.cx, self.cy, width, height)

    def undistorted(self, image: np.ndarray, interpolation: int = cv2.INTER_LINEAR) -> np.ndarray:
        """Return the picture that the pinhole alone would have taken."""
        if not self.distorts:
            return image
        matrix, size = self._matrix(), (image.shape[1], image.shape[0])
        maps = cv2.fisheye.initUndistortRectifyMap if self.fisheye else cv2.initUndistortRectifyMap
        columns, rows = maps(matrix, self._terms(), np.eye(3), matrix, size, cv2.CV_32FC1)
        return cv2.remap(image, columns, rows, interpolation, borderMode=cv2.BORDER_CONSTANT)

    def undistorted_pixels(self, pixels: np.ndarray) -> np.ndarray:
        """Return where pixels (n x 2) of the picture as taken lie in the undistorted one."""
        if not self.distorts or not len(pixels):
            return pixels
        undistort = cv2.fisheye.undistortPoints if self.fisheye else cv2.undistortPoints
        points, matrix = np.asarray(pixels, float).reshape(-1, 1, 2), self._matrix()
        return undistort(points, matrix, self._terms(), P=matrix).reshape(-1, 2)

    def _terms(self) -> np.ndarray:
        return np.array(self.distortion or (0.0,) * FISHEYE_TERMS)

    def _matrix(self) -> np.ndarray:
        return np.array([[self.fx, 0.0, self.cx], [0.0, self.fy, self.cy], [0.0, 0.0, 1.0]])
