"""Rotations: matrices and quaternions."""

from __future__ import annotations

import numpy as np


def quaternion_xyzw(rotation: np.ndarray) -> np.ndarray:
    """Return a rotation matrix as x, y, z, w, of length one, from its largest part: no part is a difference of near numbers."""
    m = rotation
    squares = np.array(
        [1 + m[0, 0] - m[1, 1] - m[2, 2], 1 - m[0, 0] + m[1, 1] - m[2, 2], 1 - m[0, 0] - m[1, 1] + m[2, 2], 1 + np.trace(m)]
    )
    largest = int(np.argmax(squares))
    if largest == 3:
        q = np.array([m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1], squares[3]])
    elif largest == 0:
        q = np.array([squares[0], m[0, 1] + m[1, 0], m[0, 2] + m[2, 0], m[2, 1] - m[1, 2]])
    elif largest == 1:
        q = np.array([m[0, 1] + m[1, 0], squares[1], m[1, 2] + m[2, 1], m[0, 2] - m[2, 0]])
    else:
        q = np.array([m[0, 2] + m[2, 0], m[1, 2] + m[2, 1], squares[2], m[1, 0] - m[0, 1]])
    return q / np.linalg.norm(q)


def rotation(quaternion: np.ndarray) -> np.ndarray:
    """Return a quaternion (x, y, z, w; of any length) as a matrix."""
    x, y, z, w = quaternion / np.linalg.norm(quaternion)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def pose_of(translation: np.ndarray, quaternion: np.ndarray) -> np.ndarray:
    """Return a translation and a quaternion (x, y, z, w; of any length) as a pose (4 x 4)."""
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = rotation(quaternion), translation
    return pose
