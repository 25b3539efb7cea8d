"""Trajectory: poses over time, and the pose at a photograph's time."""

from __future__ import annotations

import bisect
from collections.abc import Iterable
from decimal import Decimal, InvalidOperation
from pathlib import Path

import numpy as np

from ..errors import RevisitError

# Between two poses further apart than this nothing is made up.
MAX_GAP_NS = 250_000_000
# Before the first pose and after the last a photograph may lie by so much.
MAX_OUTSIDE_NS = 20_000_000


class Trajectory:
    """Poses (4 x 4, a fixed frame from a moving one) by time in nanoseconds."""

    def __init__(
        self,
        name: str,
        poses: Iterable[tuple[int, np.ndarray, np.ndarray]],
        moving_from_wanted: np.ndarray | None = None,
    ) -> None:
        """Take (time, translation, quaternion x y z w) in any order; of one time the last counts.

        `moving_from_wanted` (4 x 4) is where the frame that is asked for stands in the one that the poses are of.
        """
        self.name = name
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
            return _matrix(*self._poses[after])
        if after == 0 or after == len(self._times):
            nearest = min(after, len(self._times) - 1)
            near = abs(self._times[nearest] - stamp_ns) <= MAX_OUTSIDE_NS
            return _matrix(*self._poses[nearest]) if near else None
        t0, t1 = self._times[after - 1], self._times[after]
        if t1 - t0 > MAX_GAP_NS:
            return None
        share = (stamp_ns - t0) / (t1 - t0)
        (p0, q0), (p1, q1) = self._poses[after - 1], self._poses[after]
        # The two are near: the normalised mean of the quaternions is the rotation between them.
        mixed = (1 - share) * q0 + share * (q1 if np.dot(q0, q1) >= 0 else -q1)
        return _matrix((1 - share) * p0 + share * p1, mixed)


def read_tum(path: Path) -> Trajectory:
    """Read a trajectory in TUM's format: lines of `seconds x y z qx qy qz qw`."""
    poses = []
    try:
        lines = path.read_text("utf-8-sig").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise RevisitError(f"{path}: cannot be read: {error}") from error
    for number, line in enumerate(lines, 1):
        words = line.replace(",", " ").split()
        if not words or words[0].startswith("#"):
            continue
        try:
            stamp_ns = nanoseconds(words[0])
            values = [float(word) for word in words[1:8]]
        except ValueError as error:
            raise RevisitError(f"{path}, line {number}: no line of `seconds x y z qx qy qz qw`") from error
        poses.append((stamp_ns, *_checked(values, f"{path}, line {number}")))
    return Trajectory(str(path), poses)


def nanoseconds(seconds: str) -> int:
    """Return decimal seconds in nanoseconds, to the last digit."""
    try:
        value = Decimal(seconds)
    except InvalidOperation as error:
        raise ValueError(seconds) from error
    if not value.is_finite() or abs(value) >= 10**12:
        raise ValueError(seconds)
    return int(value * 1_000_000_000)


def _checked(values: list[float], where: str) -> tuple[np.ndarray, np.ndarray]:
    if len(values) != 7 or not np.isfinite(values).all() or np.linalg.norm(values[3:]) < 1e-6:
        raise RevisitError(f"{where}: no pose of seven numbers, x y z qx qy qz qw")
    return np.array(values[:3]), np.array(values[3:]) / np.linalg.norm(values[3:])


def _matrix(translation: np.ndarray, quaternion: np.ndarray) -> np.ndarray:
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = rotation(quaternion), translation
    return pose


def rotation(quaternion: np.ndarray) -> np.ndarray:
    """Return a quaternion (x, y, z, w; of any length) as a matrix."""
    x, y, z, w = quaternion / np.linalg.norm(quaternion)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
