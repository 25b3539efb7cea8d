"""Sample building: a camera walks through corridors that look alike, some of them twice."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from ..errors import RevisitError
from .walls import DOORS, HEIGHT_M, LENGTH_M, PX_PER_M, WIDTH_M, end_wall, floor_or_ceiling, side_wall

WIDTH_PX, HEIGHT_PX = 800, 600
FOCAL_PX = 600.0
EYE_M = 1.5
STOREY_M = 3.5
STEPS = 9
NOISE = 3.0
# Corridors of the walk, in order: each is walked through, two of them again. 3 is the twin of 2, poster by poster.
WALK = ("1", "2", "3", "1", "4", "2")


@dataclass(frozen=True)
class Corridor:
    """A box: x across (0 left), y down from the ceiling, z along. Faces are pictures of the walls."""

    left: np.ndarray
    right: np.ndarray
    far: np.ndarray
    floor: np.ndarray
    ceiling: np.ndarray


@dataclass(frozen=True, eq=False)
class Shot:
    """One photograph of the walk: its picture, its depths in metres, and where the camera stood (4 x 4)."""

    name: str
    floor: str
    image: np.ndarray
    depth: np.ndarray
    building_from_camera: np.ndarray


def corridor(floor: str) -> Corridor:
    """Return the corridor of a floor; floors differ in their plates alone."""
    plates = [f"{floor}{number:02}" for number in range(1, 2 * DOORS + 1)]
    return Corridor(
        side_wall(plates[0::2], 1), side_wall(plates[1::2], 2), end_wall(3), floor_or_ceiling(4, 120), floor_or_ceiling(5, 225)
    )


def draw(folder: Path) -> int:
    """Write the photographs and `truth.csv`; return how many photographs there are."""
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise RevisitError(f"{folder}: must be a new or an empty folder")
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise RevisitError(f"{folder}: cannot be made: {error.strerror}") from error
    rows = []
    for shot in walk():
        if not cv2.imwrite(str(folder / shot.name), shot.image, [cv2.IMWRITE_JPEG_QUALITY, 90]):
            raise RevisitError(f"{folder / shot.name}: cannot be written")
        rows.append((shot.name, shot.floor))
    with (folder / "truth.csv").open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(("frame", "floor"))
        writer.writerows(rows)
    return len(rows)


def walk() -> Iterator[Shot]:
    """Yield the photographs of the walk in order."""
    for visit, floor in enumerate(WALK, 1):
        building, rng = corridor(floor), np.random.default_rng(visit)
        for step in range(STEPS):
            # Along the middle, looking at one wall and then at the other, never twice in quite the same way.
            z = 0.6 + step * (LENGTH_M - 6.0) / (STEPS - 1) + rng.uniform(-0.15, 0.15)
            x = WIDTH_M / 2 + rng.uniform(-0.2, 0.2)
            yaw = np.deg2rad(22.0 * np.sin(step * 0.9 + 0.4) + rng.uniform(-3, 3))
            image, depth = _photograph(building, x, z, yaw)
            image = np.clip(image + rng.normal(0, NOISE, image.shape), 0, 255).astype(np.uint8)
            pose = np.eye(4)
            pose[:3, :3] = [[np.cos(yaw), 0, np.sin(yaw)], [0, 1, 0], [-np.sin(yaw), 0, np.cos(yaw)]]
            pose[:3, 3] = x, HEIGHT_M - EYE_M - STOREY_M * int(floor), z
            yield Shot(f"visit{visit}_frame_{step + 1:04}.jpg", floor, image, depth, pose)


def _photograph(building: Corridor, x: float, z: float, yaw: float) -> tuple[np.ndarray, np.ndarray]:
    """Cast a ray for each pixel to the wall that it meets; return the picture, and depths along the optical axis."""
    u, v = np.meshgrid(np.arange(WIDTH_PX) - WIDTH_PX / 2, np.arange(HEIGHT_PX) - HEIGHT_PX / 2)
    a, b = u / FOCAL_PX, v / FOCAL_PX
    dx, dy, dz = a * np.cos(yaw) + np.sin(yaw), b, np.cos(yaw) - a * np.sin(yaw)
    eye = HEIGHT_M - EYE_M
    with np.errstate(divide="ignore", invalid="ignore"):
        across = np.where(dx > 0, (WIDTH_M - x) / dx, np.where(dx < 0, -x / dx, np.inf))
        down = np.where(dy > 0, (HEIGHT_M - eye) / dy, np.where(dy < 0, -eye / dy, np.inf))
        along = np.where(dz > 0, (LENGTH_M - z) / dz, np.inf)
    distance = np.minimum(np.minimum(across, down), along)
    px, py, pz = x + distance * dx, eye + distance * dy, z + distance * dz
    image = np.zeros((HEIGHT_PX, WIDTH_PX, 3), np.float32)
    side, level, end = distance == across, distance == down, distance == along
    # Walls are drawn as seen by a person who faces them: on the left one z runs to the right, on the right one to the left.
    for where, wall, s, t in (
        (side & (dx < 0), building.left, pz, py),
        (side & (dx > 0), building.right, LENGTH_M - pz, py),
        (level & (dy > 0), building.floor, pz, px),
        (level & (dy < 0), building.ceiling, pz, px),
        (end, building.far, px, py),
    ):
        image[where] = _sample(wall, s, t)[where]
    # Light falls off with distance.
    return image * (1.0 / (1.0 + 0.035 * distance))[:, :, None], distance


def _sample(wall: np.ndarray, s: np.ndarray, t: np.ndarray) -> np.ndarray:
    column, row = (s * PX_PER_M).astype(np.float32), (t * PX_PER_M).astype(np.float32)
    return cv2.remap(wall, column, row, cv2.INTER_AREA, borderMode=cv2.BORDER_REPLICATE).astype(np.float32)
