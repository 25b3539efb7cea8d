"""Frames: photographs in order, with the video that each belongs to, and what is known of each."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import cv2
import numpy as np

from ..errors import RevisitError
from ..left_out import LeftOut, Unreadable
from .camera import Calibration
from .decoding import decoded, read_bytes
from .ids import ids_of
from .pinhole import Pinhole
from .turn import Turn

SUFFIXES = {".jpg", ".jpeg", ".png", ".bmp", ".webp", ".tif", ".tiff", ".heic", ".heif", ".hif"}
# Pictures of cameras and of other programs that are not read here.
OTHERS = {*".gif .jp2 .j2k .jxl .avif .psd .svg .dng .raw .cr2 .cr3 .nef .arw .orf .rw2 .raf .pef .srw .x3f".split()}
# How hidden files and systems' own folders begin, which hold pictures that nobody took.
HIDDEN = (".", "__MACOSX", "@eaDir", "$RECYCLE.BIN")


class View(NamedTuple):
    """A photograph, undistorted (BGR): all that decides what is read in it, its pixels, and how a person sees them."""

    key: bytes
    image: np.ndarray
    turn: Turn


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

    def view(self) -> View:
        """Return the photograph in the pixels that its camera is of.

        Raises:
            Unreadable: It cannot be read.
        """
        data, known = read_bytes(self.path, self.shown), self.calibration
        image, turn = decoded(data, cv2.IMREAD_COLOR, self.shown), Turn()
        if known is None:
            return View(data, image, turn)
        if known.size is not None:
            stored = decoded(data, cv2.IMREAD_COLOR | cv2.IMREAD_IGNORE_ORIENTATION, self.shown)
            # A model is mostly of the pixels as they are stored, however the camera was held.
            if stored.shape[1::-1] == known.size:
                image, turn = stored, Turn.between(stored, image)
        done = (repr(known) if known.distorts else "") + (repr(turn) if any(turn) else "")
        return View(data + done.encode(), known.undistorted(image), turn)

    def depths_m(self, camera: Pinhole | None) -> np.ndarray | None:
        """Return depths along the optical axis, pixel for pixel of the undistorted picture (if it is given); 0: not measured."""
        # Seen from a camera whose way nobody knows, a measured distance would place one sign in many places.
        if self.depth is None or self.session_from_camera is None:
            return None
        path = self.depth.path
        image = decoded(read_bytes(path, path), cv2.IMREAD_UNCHANGED, path)
        if image.ndim != 2 or image.dtype != np.uint16:
            raise Unreadable(path, "not a depth image of 16 bits")
        if camera is not None and image.shape != (camera.height, camera.width):
            sizes = f"{image.shape[1]} x {image.shape[0]}, but its picture is {camera.width} x {camera.height}"
            raise Unreadable(path, f"a depth image of {sizes}")
        if self.calibration is not None:
            # A depth between that of two surfaces would be that of neither.
            image = self.calibration.undistorted(image, cv2.INTER_NEAREST)
        return image.astype(np.float64) * self.depth.metres_per_unit


def readable(frames: Iterable[Frame], focal_px: float | None, left_out: LeftOut) -> Iterator[tuple[int, Frame, View, Pinhole]]:
    """Yield the photographs that can be read, each with its number among all and its camera."""
    for index, frame in enumerate(frames):
        with left_out.part():
            view, known = frame.view(), frame.calibration
            camera = Pinhole.of(view.image, focal_px) if known is None else known.camera(view.image, frame.shown)
            yield index, frame, view, camera


def list_frames(folder: Path, left_out: LeftOut | None = None) -> list[Frame]:
    """Return the photographs below `folder`, by folder, video and number; hidden files are none."""
    if not folder.is_dir():
        raise RevisitError(f"{folder}: no such folder")
    left_out = LeftOut() if left_out is None else left_out
    found = sorted(path for path in folder.rglob("*") if path.suffix.lower() in SUFFIXES | OTHERS and path.is_file())
    found = [path for path in found if not any(part.startswith(HIDDEN) for part in path.relative_to(folder).parts)]
    for path in found:
        if path.suffix.lower() in OTHERS:
            left_out.add(path, f"{path.suffix.lower()} is not read here: save it as JPEG or PNG")
    paths = [path for path in found if path not in left_out]
    if not paths:
        raise RevisitError("; ".join((f"{folder}: no photographs in it ({', '.join(sorted(SUFFIXES))})", *left_out.told())))
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
