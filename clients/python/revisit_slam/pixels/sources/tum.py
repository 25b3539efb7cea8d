"""TUM: a sequence of the TUM RGB-D benchmark (Sturm et al., IROS 2012): colour, depth and ground truth."""

from __future__ import annotations

import bisect
from dataclasses import replace
from pathlib import Path

import numpy as np

from ...errors import RevisitError
from ...files import text_of
from ...left_out import LeftOut
from ..camera import Calibration
from ..frames import DepthImage, Frame
from ..stamps import nanoseconds
from ..trajectory import Trajectory, read_tum
from .source import Source, every, listed

# The benchmark's default: depth images are registered to the colour camera, whose lens is taken for ideal.
DEFAULT = Calibration(525.0, 525.0, 319.5, 239.5, size=(640, 480))
UNITS_PER_METRE = 5000.0
FORM = "seconds file"
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
    source = Source([], str(folder))
    if calibration is None:
        source.assumed.append("the benchmark's camera, 525,525,319.5,239.5 (--calibration)")
    pictures = every(_listed(folder / "rgb.txt", source.left_out), every_s)
    known = {"video": folder.resolve().name, "calibration": calibration or DEFAULT}
    source = replace(source, frames=[replace(frame, **known) for frame in pictures])
    truth, depth = folder / "groundtruth.txt", folder / "depth.txt"
    if trajectory is None and truth.exists():
        trajectory = read_tum(truth)
    if trajectory is None:
        return source
    source = source.along(trajectory, f"those of {Path(trajectory.name).name}")
    depths = _listed(depth, source.left_out) if depth.exists() else []
    return _measured(source, depths, units_per_metre) if depths else source


def _measured(source: Source, depths: list[Frame], units_per_metre: float | None) -> Source:
    """Return it with the depth image of each picture."""
    units = units_per_metre or UNITS_PER_METRE
    frames = [replace(frame, depth=_nearest(depths, frame.stamp_ns or 0, 1 / units)) for frame in source.frames]
    measuring = [frame for frame in frames if frame.depth is not None]
    medians: list[float] = []
    for frame in measuring[:: len(measuring) // SAMPLES + 1]:
        with LeftOut().part():  # Playing tells it.
            depths_m = frame.depths_m(None)
            medians += [np.median(depths_m[depths_m > 0])] if depths_m is not None and depths_m.any() else []
    hint = "" if units_per_metre else f", as TUM's own (--depth-units-per-metre; {OTHERS})"
    told = f"depth images have {units:g} units a metre{hint}"
    if medians:
        told += f": the median depth is then {np.median(medians):.2f} m"
        if not MEDIAN_M[0] <= np.median(medians) <= MEDIAN_M[1]:
            raise RevisitError(f"{source.title}: {told}, which cannot be")
    source.assumed.extend([told] if hint else [])
    return replace(source, frames=frames, distances="measured by depth images")


def _nearest(depths: list[Frame], stamp_ns: int, metres_per_unit: float) -> DepthImage | None:
    after = bisect.bisect_left(depths, stamp_ns, key=lambda frame: frame.stamp_ns or 0)
    near = min(depths[max(after - 1, 0) : after + 1], key=lambda frame: abs((frame.stamp_ns or 0) - stamp_ns))
    return DepthImage(near.path, metres_per_unit) if abs((near.stamp_ns or 0) - stamp_ns) <= MAX_APART_NS else None


def _listed(file: Path, left_out: LeftOut) -> list[Frame]:
    """Read a list of `seconds file`; names may have blanks."""
    lines = enumerate(text_of(file, f"a TUM list of `{FORM}`").splitlines(), 1)
    rows = [(number, line.strip().split(None, 1)) for number, line in lines if line.strip() and not line.lstrip().startswith("#")]
    return listed(file, file.parent, FORM, rows, nanoseconds, left_out)
