"""Video: pictures taken from a film at even times."""

from __future__ import annotations

import os
from pathlib import Path

import cv2
import numpy as np

from ...errors import RevisitError
from ...files import not_a
from ..camera import Calibration
from ..frames import Frame
from ..ids import plain_id
from ..trajectory import Trajectory
from .source import Source, too_near

JPEG_QUALITY = 95


def open_video(
    file: Path, calibration: Calibration | None, trajectory: Trajectory | None, every_s: float, work: Path
) -> Source:
    """Open a film; its pictures are kept in `work`. Times begin with the film's."""
    if not file.is_file():
        raise RevisitError(f"{file}: no such file")
    # What the decoder thinks of a file that is no film is told in one line, by us.
    os.environ.setdefault("OPENCV_FFMPEG_LOGLEVEL", "-8")
    film = cv2.VideoCapture(str(file))
    frames: list[Frame] = []
    unread = 0
    try:
        rate = film.get(cv2.CAP_PROP_FPS)
        number = -1
        while film.grab():
            number += 1
            stamp_ns = _time_ns(film, number, rate)
            if too_near(frames, stamp_ns, every_s):
                continue
            done, image = film.retrieve()
            if not done:
                unread += 1
                continue
            name = plain_id(f"{file.stem}-{number:06}")
            path = save(image, work / f"{number:06}.jpg")
            origin = f"{file}, picture {number}"
            frames.append(Frame(name, path, file.stem, number, stamp_ns, calibration=calibration, origin=origin))
        announced = max(int(film.get(cv2.CAP_PROP_FRAME_COUNT)), number + 1)
        unread += announced - (number + 1)
    finally:
        film.release()
    if not frames:
        raise not_a("a film that OpenCV reads", file)
    source = Source(frames, str(file))
    # Some films announce one picture more than they have.
    if unread > 1:
        source.left_out.add(file, f"pictures of the {announced} that it announces cannot be read", unread)
    return source if trajectory is None else source.along(trajectory)


def save(image: np.ndarray, path: Path) -> Path:
    """Write a picture to a file and return its name."""
    if not cv2.imwrite(str(path), image, [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY]):
        raise RevisitError(f"{path}: cannot be written: is the disk full?")
    return path


def _time_ns(film: cv2.VideoCapture, number: int, rate: float) -> int:
    """Return the time of the picture just grabbed; films whose pictures carry none have an even rate."""
    position_ms = film.get(cv2.CAP_PROP_POS_MSEC)
    if number > 0 and position_ms <= 0 and rate > 0:
        position_ms = 1000.0 * number / rate
    return max(int(round(position_ms * 1e6)), 0)
