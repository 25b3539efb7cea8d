"""Trajectory: poses over time, and the pose at a photograph's time."""

from __future__ import annotations

import bisect
import re
from collections import Counter
from collections.abc import Iterable
from decimal import Decimal
from pathlib import Path

import numpy as np

from ..errors import RevisitError
from ..files import text_of
from ..left_out import LeftOut
from .pose_columns import METRES, NANOSECONDS, TUM, Columns, columns_of
from .rotations import pose_of
from .stamps import UNIT_NAMES, unit_ns

# Between two poses further apart than this nothing is made up.
MAX_GAP_NS = 250_000_000
# Before the first pose and after the last a photograph may lie by so much.
MAX_OUTSIDE_NS = 20_000_000
FORM = "seconds x y z qx qy qz qw"
UNNAMED: Columns = {name: (place, "") for place, name in enumerate(TUM)}
NUMBER = re.compile(r"[-+]?(\.?\d.*|nan|inf)", re.IGNORECASE)
GRAPH = re.compile("VERTEX|EDGE|PARAMS")
TIMES_OF_RTABMAP = "RTAB-Map writes times with `rtabmap-export --poses_camera --poses_format 10`"
MATRIX = (
    f"a matrix without a time. {TIMES_OF_RTABMAP}; to KITTI's poses "
    "evo's contrib/kitti_poses_and_timestamps_to_trajectory.py adds times.txt"
)
POSITION_MAX_M = 1e9
# A robot's poses are not hours apart.
STEP_MAX_NS = 3600 * 10**9


class Trajectory:
    """Poses (4 x 4, a fixed frame from a moving one) by time in nanoseconds."""

    def __init__(
        self,
        name: str,
        poses: Iterable[tuple[int, np.ndarray, np.ndarray]],
        moving_from_wanted: np.ndarray | None = None,
        assumed: tuple[str, ...] = (),
        left_out: LeftOut | None = None,
    ) -> None:
        """Take (time, translation, quaternion x y z w) in any order; of one time the last counts.

        `moving_from_wanted` (4 x 4) is where the frame that is asked for stands in the one that the poses are of.
        """
        self.name, self.assumed, self.left_out = name, assumed, left_out or LeftOut()
        self._moving_from_wanted = np.eye(4) if moving_from_wanted is None else moving_from_wanted
        by_time = {stamp_ns: (translation, quaternion) for stamp_ns, translation, quaternion in poses}
        self._times = sorted(by_time)
        self._poses = [by_time[stamp_ns] for stamp_ns in self._times]
        if not self._times:
            raise RevisitError(f"{name}: no poses in it")

    @property
    def span_s(self) -> tuple[float, float]:
        """First and last time in seconds."""
        return self._times[0] / 1e9, self._times[-1] / 1e9

    def at(self, stamp_ns: int) -> np.ndarray | None:
        """Return the pose at a time, between the two poses around it; None where there are none near."""
        pose = self._between(stamp_ns)
        return None if pose is None else pose @ self._moving_from_wanted

    def _between(self, stamp_ns: int) -> np.ndarray | None:
        after = bisect.bisect_left(self._times, stamp_ns)
        if after < len(self._times) and self._times[after] == stamp_ns:
            return pose_of(*self._poses[after])
        if after == 0 or after == len(self._times):
            nearest = min(after, len(self._times) - 1)
            near = abs(self._times[nearest] - stamp_ns) <= MAX_OUTSIDE_NS
            return pose_of(*self._poses[nearest]) if near else None
        t0, t1 = self._times[after - 1], self._times[after]
        if t1 - t0 > MAX_GAP_NS:
            return None
        share = (stamp_ns - t0) / (t1 - t0)
        (p0, q0), (p1, q1) = self._poses[after - 1], self._poses[after]
        # The two are near: the normalised mean of the quaternions is the rotation between them.
        mixed = (1 - share) * q0 + share * (q1 if np.dot(q0, q1) >= 0 else -q1)
        return pose_of((1 - share) * p0 + share * p1, mixed)


def read_tum(path: Path) -> Trajectory:
    """Read a trajectory: the columns, and the unit of times, that the file names, else TUM's; bad lines are left out.

    Raises:
        RevisitError: It is of another form, or more than half of its lines are bad.
    """
    columns, width, rows = _lines(path)
    left_out, poses, landmarks = LeftOut(), [], 0
    for number, cells in rows:
        pose = _pose(columns, cells) if len(cells) == width else f"not of {width} columns"
        if isinstance(pose, str):
            left_out.add(f"line {number}", pose)
        elif poses and pose[0] == 0 and poses[0][0] > 0:
            # RTAB-Map's format 11 ends with landmarks, which have no time.
            landmarks += 1
        else:
            poses.append(pose)
    if not poses or 2 * left_out.count > len(rows):
        raise RevisitError(f"{path}: no poses in it: {'; '.join(left_out.told()) or f'no line of `{FORM}`'}")
    unit, assumed = _unit(path, columns, sorted(time for time, *_ in poses))
    assumed += (f"{landmarks} lines without a time are landmarks of RTAB-Map",) if landmarks else ()
    return Trajectory(str(path), [(int(time * unit), *pose) for time, *pose in poses], assumed=assumed, left_out=left_out)


def _lines(path: Path) -> tuple[Columns, int, list[tuple[int, list[str]]]]:
    """Return the columns of a pose, how many columns there are in all, and the rows with their lines."""
    columns, width, rows = UNNAMED, len(TUM), []
    for number, line in enumerate(text_of(path, f"lines of `{FORM}`").splitlines(), 1):
        cells, is_comment = _cells(line.lstrip(" \t#%")), line.lstrip().startswith(("#", "%"))
        if not is_comment and (rows or any(map(NUMBER.fullmatch, cells))):
            rows += [(number, cells)] if any(cells) else []
        elif not rows and any(cells):
            named = columns_of(cells)
            if len(named) == len(TUM):
                columns, width = named, len(cells)
            # A comment may say anything, but one that names half of a pose names columns.
            elif not is_comment or len(named) >= len(TUM) // 2:
                lacking = ", ".join(name for name in TUM if name not in named)
                raise RevisitError(f"{path}, line {number}: no line of `{FORM}`; as names of columns it lacks {lacking}")
    count = Counter(len(cells) for _, cells in rows).most_common(1)[0][0] if rows else width
    if any(GRAPH.match(cells[0]) for _, cells in rows[:1]):
        raise RevisitError(f"{path}: a pose graph without times. {TIMES_OF_RTABMAP}")
    if columns is UNNAMED and count != width:
        told = MATRIX if count in (12, 16) else f"`{FORM}` has {width}: name them all in a first line, `# timestamp x y z ..`"
        raise RevisitError(f"{path}: {count} numbers a line: {told}")
    return columns, width, rows


def _cells(line: str) -> list[str]:
    """Return a line's cells; where `;` is between them a comma is that of a decimal number."""
    separator = next((sign for sign in ";,\t" if sign in line), None)
    line = line.replace(",", ".") if separator == ";" else line
    # A unit belongs to the name before it.
    line = re.sub(r"\s+(?=[\[(])", "", line).strip().rstrip(separator)
    return [cell.strip(' "') for cell in line.split(separator)]


def _pose(columns: Columns, cells: list[str]) -> tuple[Decimal, np.ndarray, np.ndarray] | str:
    """Return time, translation and quaternion of a line, or why it has none."""
    try:
        time = Decimal(cells[columns["t"][0]])
        values = np.array([float(cells[place]) * METRES.get(unit, 1.0) for place, unit in map(columns.get, TUM[1:])])
    except (ArithmeticError, ValueError):
        return "no numbers"
    if not time.is_finite() or abs(time) >= 10**20 or not np.isfinite(values).all():
        return "no finite numbers"
    if np.abs(values[:3]).max() > POSITION_MAX_M:
        return f"a position beyond {POSITION_MAX_M:g} m"
    length = np.linalg.norm(values[3:])
    return (time, values[:3], values[3:] / length) if abs(length - 1) < 0.1 else "no quaternion of length 1"


def _unit(path: Path, columns: Columns, times: list[Decimal]) -> tuple[int, tuple[str, ...]]:
    """Return the nanoseconds of the times' unit, and what was assumed."""
    named = NANOSECONDS.get(columns["t"][1])
    unit = named or unit_ns(times[len(times) // 2])
    steps = sorted(later - earlier for earlier, later in zip(times, times[1:]))
    if unit is None or steps and steps[len(steps) // 2] * unit > STEP_MAX_NS:
        told = f"the unit of times like {times[-1]} is not known"
        raise RevisitError(f"{path}: {told}: name it in a first line, `# timestamp[ns] x y z ..`")
    if named or unit == NANOSECONDS["s"]:
        return unit, ()
    order = ("quaternions are x y z w",) if columns is UNNAMED else ()
    return unit, (f"times are in {UNIT_NAMES[unit]}, by their digits", *order)
