"""Overlap of two photographs: the homography between their features, and the rotation in it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import cv2
import numpy as np

from .features import Features
from .pinhole import Pinhole

RATIO = 0.8
MAX_HAMMING = 64
MAX_ERROR_PX = 6.0
MIN_MATCHES = 8


@dataclass(frozen=True)
class Overlap:
    """Inliers of the homography, the share of the newer picture that the older one shows, and the rotation."""

    inliers: int
    share: float
    older_from_newer: np.ndarray
    homography: np.ndarray | None

    def between(self, older: np.ndarray, newer: np.ndarray) -> Overlap:
        """Return it between other pixels: `older` leads to those of the older picture, `newer` from those of the newer."""
        return self if self.homography is None else replace(self, homography=older @ self.homography @ newer)


NONE = Overlap(0, 0.0, np.eye(3), None)


def overlap(newer: Features, older: Features, camera: Pinhole) -> Overlap:
    """Match two photographs of one camera."""
    pairs = _matches(newer.descriptors, older.descriptors)
    if len(pairs) < MIN_MATCHES:
        return NONE
    here, there = newer.keypoints[pairs[:, 0], :2], older.keypoints[pairs[:, 1], :2]
    cv2.setRNGSeed(0)
    homography, mask = cv2.findHomography(here, there, cv2.RANSAC, MAX_ERROR_PX, maxIters=1000, confidence=0.999)
    if homography is None:
        return NONE
    kept = mask.ravel().astype(bool)
    if kept.sum() < 3:
        return NONE
    rotation = _rotation(camera.bearings(here[kept]), camera.bearings(there[kept]))
    return Overlap(int(kept.sum()), _share(homography, camera), rotation, homography)


def _matches(here: np.ndarray, there: np.ndarray) -> np.ndarray:
    if len(here) < 2 or len(there) < 2:
        return np.zeros((0, 2), int)
    matcher = cv2.BFMatcher(cv2.NORM_HAMMING)
    forth = matcher.knnMatch(here, there, k=2)
    back = {match.queryIdx: match.trainIdx for match in matcher.match(there, here)}
    return np.array(
        [
            (best.queryIdx, best.trainIdx)
            for best, next_best in forth
            if best.distance <= MAX_HAMMING
            and best.distance < RATIO * next_best.distance
            and back.get(best.trainIdx) == best.queryIdx
        ],
        int,
    ).reshape(-1, 2)


def _rotation(here: np.ndarray, there: np.ndarray) -> np.ndarray:
    """Return the rotation that turns bearings `here` into `there` best (Kabsch)."""
    u, _, vt = np.linalg.svd(there.T @ here)
    return u @ np.diag([1.0, 1.0, np.sign(np.linalg.det(u @ vt))]) @ vt


def _share(homography: np.ndarray, camera: Pinhole) -> float:
    """Return which share of a grid over the newer picture falls inside the older one."""
    xs, ys = np.meshgrid(np.linspace(0, camera.width, 9), np.linspace(0, camera.height, 7))
    points = np.column_stack((xs.ravel(), ys.ravel(), np.ones(xs.size))) @ homography.T
    ahead = points[:, 2] > 1e-9
    x, y = points[ahead, 0] / points[ahead, 2], points[ahead, 1] / points[ahead, 2]
    return float(np.sum((x >= 0) & (x <= camera.width) & (y >= 0) & (y <= camera.height)) / xs.size)
