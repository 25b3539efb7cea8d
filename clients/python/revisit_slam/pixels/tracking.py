"""Tracking: which photographs belong to one session, how the camera turned, and which overlap.

Photographs alone measure no distance: a pose is the rotation between overlapping pictures, with translation zero,
unless the photographs' source tells it.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from .features import Features
from .frames import Frame
from .ids import plain_id
from .overlap import Overlap, overlap
from .pinhole import Pinhole
from .rotations import quaternion_xyzw

# The view is lost where fewer inliers than this join the picture with each of the last few.
MIN_INLIERS = 15
LOOK_BACK = 3
# Of a session, before its number.
MAX_NAME = 100


@dataclass(frozen=True)
class Tracked:
    """A photograph's place in its session."""

    frame: Frame
    features: Features
    camera: Pinhole
    session: str
    session_from_camera: np.ndarray
    """4 x 4."""
    overlaps: list[tuple[str, Overlap]] = field(default_factory=list)

    @property
    def covisible(self) -> list[dict[str, Any]]:
        """The photographs that it overlaps, as the API takes them."""
        return [{"keyframe": id, "shared": found.inliers} for id, found in self.overlaps]


class Tracker:
    """Joins each photograph to the last ones of its video, or begins a session."""

    def __init__(self) -> None:
        self._recent: deque[Tracked] = deque(maxlen=LOOK_BACK)
        self._sessions: dict[str, int] = {}

    def look(self, frame: Frame, features: Features, camera: Pinhole) -> Tracked:
        """Place a photograph; it counts as seen only once `keep` is called with the answer."""
        joined = []
        for older in reversed(self._recent):
            if older.frame.video == frame.video and older.camera == camera:
                found = overlap(features, older.features, camera)
                if found.inliers >= MIN_INLIERS:
                    joined.append((older, found))
        if frame.session_from_camera is not None:
            # One trajectory holds a video together, also where the view is lost.
            session = session_name(frame.session or frame.video, 1)
            return Tracked(frame, features, camera, session, frame.session_from_camera, [(older.frame.id, found) for older, found in joined])
        if not joined:
            count = self._sessions.get(frame.video, 0) + 1
            return Tracked(frame, features, camera, session_name(frame.video, count), np.eye(4))
        # The strongest join gives the rotation; ties go to the nearest picture.
        older, best = max(joined, key=lambda pair: pair[1].inliers)
        turned = np.eye(4)
        turned[:3, :3] = older.session_from_camera[:3, :3] @ best.older_from_newer
        same = [(other.frame.id, found) for other, found in joined if other.session == older.session]
        return Tracked(frame, features, camera, older.session, turned, same)

    def keep(self, tracked: Tracked) -> None:
        """Make a photograph one that later ones may overlap."""
        if not tracked.overlaps:
            self._sessions[tracked.frame.video] = self._sessions.get(tracked.frame.video, 0) + 1
        self._recent.append(tracked)


def session_name(video: str, count: int) -> str:
    """Return the name of the n-th session of a video, within what the API allows."""
    return f"{plain_id(video or 'video', MAX_NAME)}-{count}"


def quaternion(rotation: np.ndarray) -> dict[str, float]:
    """Return a rotation matrix as x, y, z, w."""
    # 0.0 is added so that no -0.0 is written.
    return {axis: round(float(value), 9) + 0.0 for axis, value in zip("xyzw", quaternion_xyzw(rotation))}
