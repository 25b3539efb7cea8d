"""Opening: the source that a command line names."""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path

from ...arguments import terms
from ..camera import Calibration
from ..trajectory import Trajectory, read_tum
from .bag import Topics, open_bag
from .colmap import open_colmap
from .euroc import open_euroc
from .images import open_images
from .source import Source
from .tum import open_tum
from .video import open_video


# Sources that pick pictures from many; their numbers count the picked ones.
PICKING = ("video", "euroc", "tum", "bag")


def open_source(chosen: argparse.Namespace, work: Path) -> Source:
    """Open what was named; pictures out of films and bags are kept in `work`. Of pictures of one id the first counts."""
    source = _opened(chosen, work)
    frames = list({frame.id: frame for frame in reversed(source.frames)}.values())[::-1]
    notes, again = source.notes, len(source.frames) - len(frames)
    if again:
        notes += (f"{again} photographs are listed twice; the first of each counts",)
    if chosen.command in PICKING:
        frames = [replace(frame, number=number) for number, frame in enumerate(frames, 1)]
    return replace(source, frames=frames, notes=notes)


def _opened(chosen: argparse.Namespace, work: Path) -> Source:
    path: Path = chosen.source
    if chosen.command == "colmap":
        return open_colmap(path, chosen.images, chosen.metres_per_unit)
    trajectory: Trajectory | None = read_tum(chosen.trajectory) if chosen.trajectory else None
    if chosen.command == "euroc":
        return open_euroc(path, trajectory, chosen.every_s)
    numbers = terms(chosen.calibration) if chosen.calibration else []
    calibration = Calibration.read("--calibration", *numbers[:4], tuple(numbers[4:])) if numbers else None
    if chosen.command == "images":
        return open_images(path, calibration, trajectory)
    if chosen.command == "video":
        return open_video(path, calibration, trajectory, chosen.every_s, work)
    if chosen.command == "tum":
        return open_tum(path, calibration, trajectory, chosen.every_s)
    topics = Topics(chosen.image_topic, chosen.camera_info_topic, chosen.odometry_topic)
    return open_bag(path, topics, calibration, trajectory, chosen.every_s, work)
