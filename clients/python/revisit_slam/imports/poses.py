"""Poses: transforms between frames as 4 x 4 matrices, named `to_from_of`: `map_from_camera` takes points of the camera to the map."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..errors import RevisitError
from ..pixels.rotations import pose_of, quaternion_xyzw
from .limits import MAX_COORDINATE_M

# Files that keep 32-bit floats are off by 1e-6; what is farther off is no rotation.
MAX_SKEW = 1e-3


def matrix(translation: Any, xyzw: Any, where: str) -> np.ndarray:
    """Return a pose from a translation and a quaternion in the order x, y, z, w, of any length."""
    translation, xyzw = np.asarray(translation, float), np.asarray(xyzw, float)
    if not np.isfinite(xyzw).all() or not np.linalg.norm(xyzw) > 1e-9:
        raise RevisitError(f"{where}: its rotation is no quaternion")
    return pose_of(checked(translation, where), xyzw)


def rigid(rows: Any, where: str) -> np.ndarray:
    """Return a pose from the numbers of a 3 x 4 or 4 x 4 matrix, row by row."""
    pose = np.eye(4)
    pose[:3] = np.asarray(rows, float).reshape(-1, 4)[:3]
    turn = pose[:3, :3]
    # Not `>`: a number that is none is above nothing.
    if not np.abs(turn @ turn.T - np.eye(3)).max() < MAX_SKEW or np.linalg.det(turn) < 0:
        raise RevisitError(f"{where}: its rotation is none")
    checked(pose[:3, 3], where)
    return pose


def checked(position: np.ndarray, where: str) -> np.ndarray:
    """Return a position that the server takes."""
    if not (np.abs(position) <= MAX_COORDINATE_M).all():
        raise RevisitError(f"{where}: its position {_told(position)} is no place")
    return position


def inverse(pose: np.ndarray) -> np.ndarray:
    """Return `b_from_a` of `a_from_b`."""
    back = np.eye(4)
    back[:3, :3] = pose[:3, :3].T
    back[:3, 3] = -pose[:3, :3].T @ pose[:3, 3]
    return back


def body(pose: np.ndarray) -> dict[str, dict[str, float]]:
    """Return a pose as the API takes it; 0.0 is added so that no -0.0 is written."""
    return {
        "translation": {axis: float(value) + 0.0 for axis, value in zip("xyz", pose[:3, 3])},
        "rotation": {axis: float(value) + 0.0 for axis, value in zip("xyzw", quaternion_xyzw(pose[:3, :3]))},
    }


def apart(one: np.ndarray, other: np.ndarray) -> tuple[float, float]:
    """Return how far two poses of one frame are from each other, in its unit and in radians."""
    turned = np.arccos(np.clip((np.trace(one[:3, :3].T @ other[:3, :3]) - 1) / 2, -1, 1))
    return float(np.linalg.norm(other[:3, 3] - one[:3, 3])), float(turned)


def moved(pose: np.ndarray, positions: np.ndarray) -> np.ndarray:
    """Return positions (n x 3) of a pose's own frame in the frame around it."""
    return positions @ pose[:3, :3].T + pose[:3, 3]


def _told(position: np.ndarray) -> str:
    return "(" + ", ".join(f"{value:g}" for value in position) + ")"
