"""TUM: a sequence of the TUM RGB-D benchmark (Sturm et al., IROS 2012): colour, depth and ground truth."""

from __future__ import annotations

import bisect
import contextlib
from dataclasses import replace
from pathlib import Path

import numpy as np

from ...errors import RevisitError
from ...files import text_of
from ...left_out import LeftOut, Unreadable
from ..camera import Calibration
from ..frames import DepthImage, Frame
from ..ids import ids_of
from ..trajectory import Trajectory, nanoseconds, read_tum
from .source import Source, every, there

# The benchmark's default: depth images are registered to the colour camera, whose lens is taken for ideal.
DEFAULT = Calibration(525.0, 525.0, 319.5, 239.5, size=(640, 480))
UNITS_PER_METRE = 5000.0
OTHERS = "RealSense and OpenLORIS have 1000"
# Colour and depth are not taken at once; nearer pairs belong together.
MAX_APART_NS = 20_000_000
# So many depth images tell how far things are; no camera within a building measures the middle of them outside of these.
SAMPLES = 5
MEDIAN_M = (0.1, 100.0)


def open_tum(
    folder: Path, calibration: Calibration | None, trajectory: Trajectory | None, every_s: float, units_per_metre: float | None
) -> Source:
    """Open a sequence: `rgb.txt`, and `depth.txt` and `groundtruth.txt` where they are there."""
    left_out = LeftOut()
    pictures = _listed(folder / "rgb.txt", left_out)
    depths = _listed(folder / "depth.txt", left_out) if (folder / "depth.txt").exists() else []
    frames = [replace(frame, calibration=calibration or DEFAULT) for frame in every(pictures, every_s)]
    truth = folder / "groundtruth.txt"
    if trajectory is None and truth.exists():
        trajectory = read_tum(truth)
    source = Source(frames, str(folder), left_out=left_out)
    if calibration is None:
        source = source.assuming("the benchmark's camera, 525,525,319.5,239.5 (--calibration)")
    if trajectory is None:
        return source
    source = source.along(trajectory, f"those of {Path(trajectory.name).name}")
    return _measured(source, depths, units_per_metre) if depths else source


def _measured(source: Source, depths: list[Frame], units_per_metre: float | None) -> Source:
    """Return it with the depth image of each picture."""
    units = units_per_metre or UNITS_PER_METRE
    frames = [replace(frame, depth=_nearest(depths, frame.stamp_ns or 0, 1 / units)) for frame in source.frames]
    images = [frame.depth for frame in frames if frame.depth is not None]
    source, lacking = replace(source, frames=frames, distances="measured by depth images"), len(frames) - len(images)
    if lacking:
        source = source.assuming(f"distances in {lacking} pictures without a depth image within {MAX_APART_NS / 1e6:g} ms")
    median_m, hint = _median_m(images), "" if units_per_metre else f", as TUM's own (--depth-units-per-metre; {OTHERS})"
    told = f"depth images have {units:g} units a metre{hint}" + (f": the median depth is then {median_m:.2f} m" if median_m else "")
    if median_m and not MEDIAN_M[0] <= median_m <= MEDIAN_M[1]:
        raise RevisitError(f"{source.title}: {told}, which cannot be")
    return source.assuming(told) if hint else source


def _median_m(images: list[DepthImage]) -> float | None:
    medians = []
    for image in images[:: len(images) // SAMPLES + 1]:
        with contextlib.suppress(Unreadable):
            units = image.units()
            medians += [np.median(units[units > 0]) * image.metres_per_unit] if units.any() else []
    return float(np.median(medians)) if medians else None


def _nearest(depths: list[Frame], stamp_ns: int, metres_per_unit: float) -> DepthImage | None:
    after = bisect.bisect_left(depths, stamp_ns, key=lambda frame: frame.stamp_ns or 0)
    near = min(depths[max(after - 1, 0) : after + 1], key=lambda frame: abs((frame.stamp_ns or 0) - stamp_ns))
    return DepthImage(near.path, metres_per_unit) if abs((near.stamp_ns or 0) - stamp_ns) <= MAX_APART_NS else None


def _listed(path: Path, left_out: LeftOut) -> list[Frame]:
    """Read a list of `seconds file`; names may have blanks."""
    listed, video, before = [], path.parent.resolve().name, left_out.count
    for number, line in enumerate(text_of(path, "a TUM list of `seconds file`").splitlines(), 1):
        words = line.split(None, 1)
        if not words or words[0].startswith("#"):
            continue
        try:
            listed.append(Frame("", path.parent / words[1].strip(), video, number, nanoseconds(words[0])))
        except (ValueError, IndexError):
            left_out.add(f"{path}, line {number}", "no line of `seconds file`")
    if not listed and left_out.count > before:
        raise RevisitError(f"{path}: no line of `seconds file` in it")
    ids = ids_of((frame.path for frame in listed), path.parent)
    frames = [replace(frame, id=ids[frame.path]) for frame in sorted(listed, key=lambda frame: (frame.stamp_ns, frame.path))]
    return there(frames, left_out)
