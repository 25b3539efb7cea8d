"""Loops that the server found, as a pose graph of a robot's base takes them.

The server's `candidate_from_query` is between cameras, and its covariance stands in the candidate's camera frame: a small
motion adds to the translation, and turns the rotation from the left, as ROS writes it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..imports.poses import inverse, matrix

# Only these models measure the whole transform; the others leave its length open.
FULL_MODELS = {"sim3", "se3"}
# A host's map has metres: a loop that wants another scale is none for it.
MAX_SCALE_OFF = 0.1


@dataclass(frozen=True, eq=False)
class Loop:
    """A loop between two cameras."""

    query: str
    candidate: str
    answer: str
    """The id of the loop query."""
    candidate_from_query: np.ndarray | None
    """None where signs alone decided, or a model that leaves the length open."""
    covariance: np.ndarray | None


@dataclass(frozen=True, eq=False)
class Edge:
    """A loop as an edge between two moments of a robot's base."""

    stamps_ns: tuple[int, int]
    """Of the query, `from`, and of the candidate, `to`."""
    to_from_from: np.ndarray
    covariance: np.ndarray
    """Of `to_from_from`, in the base frame of `to`."""


@dataclass(frozen=True)
class Trust:
    """How far a transform is trusted at most; the covariance of the inliers does not show drift that all of them share."""

    translation_std_m: float = 0.05
    rotation_std_rad: float = 0.02

    def covariance(self) -> np.ndarray:
        """Return the covariance that is added to every transform's."""
        return np.diag([self.translation_std_m**2] * 3 + [self.rotation_std_rad**2] * 3)


def loop_of(answer: Any) -> Loop | None:
    """Return the loop of a loop query's answer, the best one with a whole transform if there is one; None where there is none."""
    loops = [candidate for candidate in answer.candidates if candidate.keyframe in answer.loops]
    if not loops:
        return None
    measured = [candidate for candidate in loops if _is_measured(candidate.geometry)]
    if not measured:
        return Loop(answer.keyframe, loops[0].keyframe, answer.id, None, None)
    best, geometry = measured[0], measured[0].geometry
    moved, turned = geometry.candidate_from_query.translation, geometry.candidate_from_query.rotation
    xyz, xyzw = [getattr(moved, axis) for axis in "xyz"], [getattr(turned, axis) for axis in "xyzw"]
    covariance = np.array(geometry.covariance, float).reshape(6, 6) if geometry.covariance else None
    return Loop(answer.keyframe, best.keyframe, answer.id, matrix(xyz, xyzw, "the server's transform"), covariance)


def _is_measured(geometry: Any) -> bool:
    if geometry is None or geometry.candidate_from_query is None or str(geometry.model) not in FULL_MODELS:
        return False
    return abs(geometry.candidate_from_query.scale - 1) <= MAX_SCALE_OFF


def edge_of(
    loop: Loop, stamps_ns: tuple[int, int], base_from_camera_query: np.ndarray, base_from_camera_candidate: np.ndarray, trust: Trust
) -> Edge | None:
    """Return a loop as an edge from the query's base to the candidate's; None where its transform is not measured."""
    if loop.candidate_from_query is None:
        return None
    covariance = np.zeros((6, 6)) if loop.covariance is None else loop.covariance
    jacobian = mounted_jacobian(base_from_camera_candidate, loop.candidate_from_query, inverse(base_from_camera_query))
    pose = base_from_camera_candidate @ loop.candidate_from_query @ inverse(base_from_camera_query)
    return Edge(stamps_ns, pose, jacobian @ covariance @ jacobian.T + trust.covariance())


def mounted_jacobian(left: np.ndarray, pose: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Return how a small motion of a pose moves `left @ pose @ right`; of `left` only its rotation matters."""
    turn = left[:3, :3]
    jacobian = np.zeros((6, 6))
    jacobian[:3, :3] = jacobian[3:, 3:] = turn
    jacobian[:3, 3:] = -turn @ cross(pose[:3, :3] @ right[:3, 3])
    return jacobian


def inverse_jacobian(pose: np.ndarray) -> np.ndarray:
    """Return how a small motion of a pose moves its inverse."""
    back = pose[:3, :3].T
    jacobian = np.zeros((6, 6))
    jacobian[:3, :3] = jacobian[3:, 3:] = -back
    jacobian[:3, 3:] = -back @ cross(pose[:3, 3])
    return jacobian


def cross(vector: np.ndarray) -> np.ndarray:
    """Return the matrix of the cross product with a vector."""
    x, y, z = vector
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
