"""Frames: photographs in order, with the video that each belongs to, and what is known of each."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from ..errors import RevisitError
from .camera import Calibration, Camera
from .ids import ids_of

SUFFIXES = {".jpg", ".jpeg", ".png", ".bmp", ".webp", ".tif", ".tiff"}


@dataclass(frozen=True, eq=False)
class Landmarks:
    """Triangulated points that a photograph shows."""

    ids: np.ndarray
    pixels: np.ndarray
    """n x 2, undistorted."""
    positions: np.ndarray
    """n x 3, in the session's frame."""


@dataclass(frozen=True)
class DepthImage:
    """A depth image registered to a photograph, pixel for pixel."""

    path: Path
    metres_per_unit: float


@dataclass(frozen=True, eq=False)
class Frame:
    """One photograph: its id, its video, its number there, and what its source knows of it."""

    id: str
    path: Path
    video: str
    number: int
    stamp_ns: int | None = None
    session_from_camera: np.ndarray | None = None
    """4 x 4; None where nothing tells the pose."""
    session: str | None = None
    """Whose frame the pose is in; None: that of the video."""
    calibration: Calibration | None = None
    depth: DepthImage | None = None
    landmarks: Landmarks | None = None
    origin: str = ""
    """Where the picture comes from, if it was taken out of something."""

    @property
    def shown(self) -> str:
        """What a person knows the picture by."""
        return self.origin or str(self.path)

    def picture(self) -> tuple[bytes, np.ndarray]:
        """Return what identifies it (the bytes of its file, and how it was undistorted), and the undistorted picture (BGR)."""
        data = _bytes(self.path)
        flags = cv2.IMREAD_COLOR
        if self.calibration is not None and self.calibration.size is not None:
            # The calibration is of the pixels as they are stored, however the camera was held.
            flags |= cv2.IMREAD_IGNORE_ORIENTATION
        image = cv2.imdecode(np.frombuffer(data, np.uint8), flags) if data else None
        if image is None:
            raise RevisitError(f"{self.shown}: not a picture that OpenCV reads")
        if self.calibration is None or not self.calibration.distorts:
            return data, image
        return data + repr(self.calibration).encode(), self.calibration.undistorted(image)

    def depths_m(self, camera: Camera) -> np.ndarray | None:
        """Return depths along the optical axis, pixel for pixel of the undistorted picture; 0 where none was measured."""
        if self.depth is None:
            return None
        data = _bytes(self.depth.path)
        image = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED) if data else None
        if image is None or image.ndim != 2 or image.dtype != np.uint16:
            raise RevisitError(f"{self.depth.path}: not a depth image of 16 bits that OpenCV reads")
        if image.shape != (camera.height, camera.width):
            raise RevisitError(f"{self.depth.path}: not of the size of {self.path.name}, {camera.width} x {camera.height}")
        if self.calibration is not None:
            # A depth between that of two surfaces would be that of neither.
            image = self.calibration.undistorted(image, cv2.INTER_NEAREST)
        return image.astype(np.float64) * self.depth.metres_per_unit


def _bytes(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        raise RevisitError(f"{path}: cannot be read: {error.strerror}") from error


def list_frames(folder: Path) -> list[Frame]:
    """Return the photographs below `folder`, by folder, video and number."""
    if not folder.is_dir():
        raise RevisitError(f"{folder}: no such folder")
    paths = sorted(path for path in folder.rglob("*") if path.suffix.lower() in SUFFIXES and path.is_file())
    if not paths:
        raise RevisitError(f"{folder}: no photographs in it ({', '.join(sorted(SUFFIXES))})")
    return frames_of(paths, folder)


def frames_of(paths: Iterable[Path], folder: Path) -> list[Frame]:
    """Return photographs below `folder` as frames, by folder, video and number."""
    frames = []
    for path, id in ids_of(paths, folder).items():
        video, number = split_number(path.stem)
        frames.append(Frame(id, path, "/".join((*path.relative_to(folder).parts[:-1], video)), number))
    return sorted(frames, key=lambda frame: (frame.path.parent, frame.video, frame.number, frame.id))


def split_number(stem: str) -> tuple[str, int]:
    """Return the stem without the number at its end, and the number (0 where there is none)."""
    found = re.search(r"^(.*?)[-_. ]*(?:frame|img|image)?[-_. ]*(\d+)$", stem, re.IGNORECASE)
    if found is None:
        return stem, 0
    return found.group(1), int(found.group(2))
