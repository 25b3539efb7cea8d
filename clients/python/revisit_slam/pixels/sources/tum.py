"""TUM: a sequence of the TUM RGB-D benchmark (Sturm et al., IROS 2012): colour, depth and ground truth."""

from __future__ import annotations

import bisect
from dataclasses import replace
from pathlib import Path

from ...errors import RevisitError
from ..camera import Calibration
from ..frames import DepthImage, Frame
from ..ids import ids_of
from ..trajectory import Trajectory, nanoseconds, read_tum
from .source import Source, every

# The benchmark's default: depth images are registered to the colour camera, whose lens is taken for ideal.
DEFAULT = Calibration(525.0, 525.0, 319.5, 239.5, size=(640, 480))
METRES_PER_UNIT = 1 / 5000
# Colour and depth are not taken at once; nearer pairs belong together.
MAX_APART_NS = 20_000_000


def open_tum(folder: Path, calibration: Calibration | None, trajectory: Trajectory | None, every_s: float) -> Source:
    """Open a sequence: `rgb.txt`, and `depth.txt` and `groundtruth.txt` where they are there."""
    pictures = _listed(folder / "rgb.txt")
    depths = _listed(folder / "depth.txt", may_be_empty=True) if (folder / "depth.txt").exists() else []
    video, calibration = folder.resolve().name, calibration or DEFAULT
    ids = ids_of((path for _, path in pictures), folder)
    frames = [
        Frame(ids[path], path, video, number, stamp_ns, calibration=calibration)
        for number, (stamp_ns, path) in enumerate(pictures, 1)
    ]
    frames = [replace(frame, depth=_nearest(depths, frame.stamp_ns or 0)) for frame in every(frames, every_s)]
    truth = folder / "groundtruth.txt"
    if trajectory is None and truth.exists():
        trajectory = read_tum(truth)
    source = Source(frames, str(folder))
    if trajectory is None:
        return source
    source = source.along(trajectory, f"those of {Path(trajectory.name).name}")
    measured = any(frame.depth for frame in source.frames)
    return replace(source, distances="measured by depth images") if measured else source


def _nearest(depths: list[tuple[int, Path]], stamp_ns: int) -> DepthImage | None:
    after = bisect.bisect_left(depths, stamp_ns, key=lambda pair: pair[0])
    near = min(depths[max(after - 1, 0) : after + 1], key=lambda pair: abs(pair[0] - stamp_ns), default=None)
    if near is None or abs(near[0] - stamp_ns) > MAX_APART_NS:
        return None
    return DepthImage(near[1], METRES_PER_UNIT)


def _listed(path: Path, may_be_empty: bool = False) -> list[tuple[int, Path]]:
    """Read a list of `seconds file`."""
    try:
        lines = path.read_text("utf-8-sig").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise RevisitError(f"{path}: cannot be read ({error.__class__.__name__}): a TUM sequence has one") from error
    listed = []
    for number, line in enumerate(lines, 1):
        words = line.split()
        if not words or words[0].startswith("#"):
            continue
        try:
            listed.append((nanoseconds(words[0]), path.parent / words[1]))
        except (ValueError, IndexError) as error:
            raise RevisitError(f"{path}, line {number}: no line of `seconds file`") from error
    if not listed and not may_be_empty:
        raise RevisitError(f"{path}: no photographs in it")
    return sorted(listed)
