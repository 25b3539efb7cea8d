"""Keyframe of stella_vslam, from either of its files, as an observation."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...errors import RevisitError
from ..observation import Features, Observation, nanoseconds_of
from ..point_store import PointStore
from ..poses import checked, inverse
from .camera import Camera

DESCRIPTOR_BYTES = 32
MAX_KEYFRAME_ID = 2**32 - 1


@dataclass(frozen=True, eq=False)
class Keyframe:
    """A keyframe as the files tell it; the points of its features are landmarks."""

    id: int
    stamp_s: float
    camera: str
    camera_from_world: np.ndarray
    features: Features
    loop_edges: list[int]


class Names:
    """Names of the keyframes so far, and what is known of their cameras and landmarks."""

    def __init__(self, session: str, cameras: dict[str, Camera], points: PointStore, scale: float) -> None:
        self._session, self._cameras, self._points, self._scale = session, cameras, points, scale
        self._ids: set[int] = set()

    def observation(self, keyframe: Keyframe, where: str) -> Observation:
        """Return a keyframe as an observation."""
        if keyframe.camera not in self._cameras:
            raise RevisitError(f"{where} is of camera {keyframe.camera!r}, which is not in the file")
        features = keyframe.features
        counts = [len(column) for column in (features.pixels, features.descriptors, features.points)]
        if len(set(counts)) != 1:
            raise RevisitError(f"{where} has {counts[0]} keypoints, {counts[1]} descriptors and {counts[2]} landmarks")
        world_from_camera = inverse(keyframe.camera_from_world)
        world_from_camera[:3, 3] = checked(world_from_camera[:3, 3] * self._scale, where)
        pinhole = self._cameras[keyframe.camera].pinhole
        # Pixels of a picture that shows all around are those of no pinhole: points still count.
        observes = _landmarks(features) if pinhole is None else []
        loops = [self._name(id) for id in sorted(set(keyframe.loop_edges)) if id in self._ids]
        seen = Observation(
            self._name(keyframe.id), self._session, nanoseconds_of(keyframe.stamp_s), world_from_camera, pinhole,
            features=None if pinhole is None else features.usable(), observes=observes, loops=loops,
        )  # fmt: skip
        landmarks = observes if seen.features is None else _landmarks(seen.features)
        seen.placed.update(self._points.new_of(self._points.find(landmarks, where, may_lack=True)))
        self._ids.add(keyframe.id)
        return seen

    def _name(self, id: int) -> str:
        return f"{self._session}-{id}"


def _landmarks(features: Features) -> list[int]:
    return np.unique(features.points[features.points >= 0]).tolist()
