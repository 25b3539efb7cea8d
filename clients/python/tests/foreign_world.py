"""A synthetic drive for maps of other systems: a robot turns and climbs through points that it sees from a tilted camera."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

START_S = 1_700_000_000.25
WIDTH, HEIGHT, FX, FY, CX, CY = 640, 480, 500.0, 510.0, 320.5, 240.25
# Where the camera sits on the robot: looking ahead, a little down and to the left, beside and above the base.
LOOKING_AHEAD = np.array([[0, 0, 1.0], [-1, 0, 0], [0, -1, 0]])


def turn(axis: str, angle: float) -> np.ndarray:
    """Return a rotation about an axis."""
    c, s = np.cos(angle), np.sin(angle)
    rows = {"x": [[1, 0, 0], [0, c, -s], [0, s, c]], "y": [[c, 0, s], [0, 1, 0], [-s, 0, c]], "z": [[c, -s, 0], [s, c, 0], [0, 0, 1]]}
    return np.array(rows[axis], float)


def placed(rotation: np.ndarray, translation: list[float]) -> np.ndarray:
    """Return a pose."""
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = rotation, translation
    return pose


BASE_FROM_CAMERA = placed(turn("z", 0.3) @ turn("y", 0.1) @ LOOKING_AHEAD, [0.2, 0.05, 0.4])


@dataclass(frozen=True, eq=False)
class Stand:
    """One keyframe: where the base was, and which points it saw where."""

    number: int
    stamp_s: float
    map_from_base: np.ndarray
    seen: np.ndarray
    pixels: np.ndarray

    @property
    def map_from_camera(self) -> np.ndarray:
        return self.map_from_base @ BASE_FROM_CAMERA


@dataclass(frozen=True, eq=False)
class World:
    """Points with their descriptors, and the stands of a drive that ends where it began."""

    points: np.ndarray
    descriptors: np.ndarray
    angles_deg: np.ndarray
    stands: list[Stand]


def world(stands: int = 6, points: int = 400, seed: int = 7) -> World:
    """Return a drive: its last stand sees what its first one saw."""
    random = np.random.default_rng(seed)
    places = np.column_stack((random.uniform(-12, 12, points), random.uniform(-12, 12, points), random.uniform(-2, 3, points)))
    drive = []
    for number in range(stands):
        way = 2 * np.pi * number / max(stands - 1, 1)
        pose = placed(turn("z", way) @ turn("y", 0.05 * number) @ turn("x", -0.04 * number), [np.cos(way), np.sin(way), 0.1 * number])
        drive.append(_stand(number, pose, places))
    return World(places, random.integers(0, 256, (points, 32), np.uint8), random.uniform(0, 360, points).astype(np.float32), drive)


def _stand(number: int, map_from_base: np.ndarray, points: np.ndarray) -> Stand:
    pose = map_from_base @ BASE_FROM_CAMERA
    in_camera = (points - pose[:3, 3]) @ pose[:3, :3]
    depth = np.where(in_camera[:, 2] > 0.5, in_camera[:, 2], np.nan)
    u, v = in_camera[:, 0] / depth * FX + CX, in_camera[:, 1] / depth * FY + CY
    seen = np.flatnonzero((u >= 0) & (u < WIDTH) & (v >= 0) & (v < HEIGHT))
    return Stand(number, START_S + 2.5 * number, map_from_base, seen, np.column_stack((u, v))[seen])
