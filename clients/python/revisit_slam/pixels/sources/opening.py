"""Opening: the source that a command line names."""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path

from ...arguments import EVERY_S, terms
from ..camera import Calibration
from ..frames import Frame
from ..pinhole import FOCAL_SHARE
from ..trajectory import Trajectory, read_tum
from .bag.bag import open_bag
from .colmap import open_colmap
from .euroc import open_euroc
from .images import open_images
from .source import Source
from .tum import open_tum
from .video import open_video

# Sources that pick pictures from many; their numbers count the picked ones.
PICKING = ("video", "euroc", "tum", "bag")


def open_source(chosen: argparse.Namespace, work: Path) -> Source:
    """Open what was named; pictures out of films and bags are kept in `work`. Of a picture that is listed twice the first counts.

    Raises:
        RevisitError: There is nothing to play.
    """
    source = _opened(chosen, work)
    first: dict[str, Frame] = {}
    for frame in source.frames:
        if first.setdefault(frame.id, frame) is not frame:
            source.left_out.add(f"{frame.shown}, line {frame.number}", "listed twice")
    frames = list(first.values())
    replace(source, frames=frames).checked()
    if chosen.command in PICKING:
        frames = [replace(frame, number=number) for number, frame in enumerate(frames, 1)]
        if chosen.every_s == EVERY_S:
            source.assumed.append(f"a picture every {EVERY_S:g} s is enough (--every-s)")
    if frames[0].stamp_ns is None:
        source.assumed.append("pictures are a second apart, in the order of their names")
    if frames[0].calibration is None and not getattr(chosen, "focal_px", None):
        source.assumed.append(f"a focal length of {FOCAL_SHARE:g} of the longer side (--calibration)")
    return replace(source, frames=frames)


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
        return open_tum(path, calibration, trajectory, chosen.every_s, chosen.depth_units_per_metre)
    topics = {name: getattr(chosen, f"{name}_topic") for name in ("image", "camera_info", "odometry")}
    return open_bag(path, topics, calibration, trajectory, chosen.every_s, work)
