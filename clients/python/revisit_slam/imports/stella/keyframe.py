"""Keyframe of stella_vslam, from either of its files, as an observation."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...errors import RevisitError
from ..limits import MAX_FEATURES
from ..observation import Features, Observation, nanoseconds_of
from ..poses import checked, inverse
from .camera import Camera

DESCRIPTOR_BYTES = 32
MAX_KEYFRAME_ID = 2**32 - 1


@dataclass(frozen=True, eq=False)
class Keyframe:
    """A keyframe as the files tell it; its keypoints, descriptors and landmarks are in parallel, -1 for no landmark."""

    id: int
    stamp_s: float
    camera: str
    camera_from_world: np.ndarray
    pixels: np.ndarray
    octaves: np.ndarray
    angles_deg: np.ndarray
    descriptors: np.ndarray
    landmarks: np.ndarray
    loop_edges: list[int]


class Names:
    """Names of the keyframes so far, and what is known of their cameras."""

    def __init__(self, session: str, cameras: dict[str, Camera], scale: float) -> None:
        self._session, self._cameras, self._scale = session, cameras, scale
        self._ids: set[int] = set()

    def observation(self, keyframe: Keyframe, where: str) -> Observation:
        """Return a keyframe as an observation, without the places of its landmarks."""
        if keyframe.camera not in self._cameras:
            raise RevisitError(f"{where} is of camera {keyframe.camera!r}, which is not in the file")
        columns = (keyframe.pixels, keyframe.octaves, keyframe.angles_deg, keyframe.descriptors, keyframe.landmarks)
        counts = [len(column) for column in columns]
        if len(set(counts)) != 1:
            raise RevisitError(f"{where} has {counts[0]} keypoints, {counts[3]} descriptors and {counts[4]} landmarks")
        if counts[0] > MAX_FEATURES:
            raise RevisitError(f"{where} has {counts[0]} keypoints; at most {MAX_FEATURES} are taken")
        stamp_ns = nanoseconds_of(keyframe.stamp_s)
        if stamp_ns is None:
            raise RevisitError(f"{where}: its time {keyframe.stamp_s:g} s is none")
        world_from_camera = inverse(keyframe.camera_from_world)
        world_from_camera[:3, 3] = checked(world_from_camera[:3, 3] * self._scale, where)
        pinhole = self._cameras[keyframe.camera].pinhole
        features, observes = None, []
        if pinhole is None:
            # Pixels of a picture that shows all around are those of no pinhole: points still count.
            observes = [int(id) for id in np.unique(keyframe.landmarks[keyframe.landmarks >= 0])]
        else:
            features = Features(
                keyframe.pixels, keyframe.octaves, keyframe.angles_deg, keyframe.descriptors, keyframe.landmarks.astype(np.int64)
            ).usable()  # fmt: skip
        loops = [self._name(id) for id in sorted(set(keyframe.loop_edges)) if id in self._ids]
        seen = Observation(
            self._name(keyframe.id), self._session, stamp_ns, world_from_camera, pinhole,
            features=features, observes=observes, loops=loops,
        )  # fmt: skip
        self._ids.add(keyframe.id)
        return seen

    def _name(self, id: int) -> str:
        return f"{self._session}-{id}"


def landmarks_of(seen: Observation) -> list[int]:
    """Return the landmarks that an observation names, each once."""
    if seen.features is None:
        return seen.observes
    return [int(id) for id in np.unique(seen.features.points[seen.features.points >= 0])]
