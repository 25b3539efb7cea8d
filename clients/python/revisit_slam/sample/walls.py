"""Walls of the sample building: the same doors, posters and bricks in every corridor; only the plates differ."""

from __future__ import annotations

import cv2
import numpy as np

PX_PER_M = 160
LENGTH_M = 14.0
WIDTH_M = 2.6
HEIGHT_M = 2.6
DOOR_EVERY_M = 3.0
FIRST_DOOR_M = 2.5
DOORS = 4
FONT = cv2.FONT_HERSHEY_DUPLEX


def side_wall(plates: list[str], seed: int) -> np.ndarray:
    """Return a long wall with a door and a plate every three metres."""
    wall = _plaster(LENGTH_M, HEIGHT_M, seed)
    for number, plate in enumerate(plates):
        at = FIRST_DOOR_M + DOOR_EVERY_M * number
        _box(wall, at - 0.45, 0.55, at + 0.45, HEIGHT_M, (92, 118, 150))
        _box(wall, at - 0.38, 0.65, at + 0.38, 1.5, (104, 132, 166))
        _box(wall, at + 0.3, 1.55, at + 0.38, 1.62, (40, 40, 40))
        _text(wall, plate, at + 0.85, 1.05, 0.17)
        _poster(wall, at + 1.5, seed + number)
    return wall


def end_wall(seed: int) -> np.ndarray:
    """Return the wall at an end: an exit sign over a double door."""
    wall = _plaster(WIDTH_M, HEIGHT_M, seed)
    _box(wall, 0.5, 0.75, 2.1, HEIGHT_M, (120, 110, 96))
    _box(wall, 1.29, 0.75, 1.31, HEIGHT_M, (50, 50, 50))
    _box(wall, 0.85, 0.2, 1.75, 0.55, (60, 130, 30))
    _text(wall, "EXIT", 1.3, 0.38, 0.2, ink=(255, 255, 255), paper=None)
    return wall


def floor_or_ceiling(seed: int, shade: int) -> np.ndarray:
    """Return tiles."""
    tiles = _plaster(LENGTH_M, WIDTH_M, seed, shade)
    for at in np.arange(0, LENGTH_M, 0.65):
        _box(tiles, at, 0, at + 0.02, WIDTH_M, (shade - 40,) * 3)
    for at in np.arange(0, WIDTH_M, 0.65):
        _box(tiles, 0, at, LENGTH_M, at + 0.02, (shade - 40,) * 3)
    return tiles


def _plaster(length_m: float, height_m: float, seed: int, shade: int = 205) -> np.ndarray:
    rng = np.random.default_rng(seed)
    rows, columns = round(height_m * PX_PER_M), round(length_m * PX_PER_M)
    stains = cv2.resize(rng.normal(0, 14, (rows // 16 + 1, columns // 16 + 1)), (columns, rows), interpolation=cv2.INTER_CUBIC)
    grain = cv2.GaussianBlur(rng.normal(0, 26, (rows, columns)), (0, 0), 2.0)
    return np.clip(shade + stains + grain, 0, 255).astype(np.uint8)[:, :, None].repeat(3, axis=2)


def _poster(wall: np.ndarray, at: float, seed: int) -> None:
    """Hang a poster of coloured shapes, the same in each corridor."""
    rng = np.random.default_rng(1000 + seed)
    _box(wall, at - 0.32, 0.7, at + 0.32, 1.7, (230, 230, 230))
    for _ in range(14):
        u, v, size = rng.uniform(at - 0.26, at + 0.18), rng.uniform(0.76, 1.55), rng.uniform(0.04, 0.12)
        _box(wall, u, v, u + size, v + size, tuple(int(c) for c in rng.integers(20, 220, 3)))


def _box(wall: np.ndarray, x0: float, y0: float, x1: float, y1: float, colour: tuple[int, ...]) -> None:
    corner, other = (round(x0 * PX_PER_M), round(y0 * PX_PER_M)), (round(x1 * PX_PER_M), round(y1 * PX_PER_M))
    cv2.rectangle(wall, corner, other, colour, -1)


def _text(
    wall: np.ndarray,
    text: str,
    x: float,
    y: float,
    height_m: float,
    ink: tuple[int, ...] = (30, 30, 30),
    paper: tuple[int, ...] | None = (250, 250, 250),
) -> None:
    """Write a text centred at a place, on a plate unless `paper` is None."""
    size = height_m * PX_PER_M / cv2.getTextSize("0", FONT, 1.0, 1)[0][1]
    (width, height), _ = cv2.getTextSize(text, FONT, size, 2)
    if paper is not None:
        margin = height_m * 0.6
        half = width / PX_PER_M / 2 + margin
        _box(wall, x - half, y - height_m / 2 - margin, x + half, y + height_m / 2 + margin, paper)
    place = (round(x * PX_PER_M - width / 2), round(y * PX_PER_M + height / 2))
    cv2.putText(wall, text, place, FONT, size, ink, 2, cv2.LINE_AA)
