"""Bodies: a chosen photograph as the API takes a keyframe."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..left_out import LeftOut
from .detections import detection
from .frames import View
from .global_descriptors import GlobalDescriptors
from .options import Options
from .ranges import Ranges
from .signs import Sign
from .tracking import Tracked, quaternion
from .vocabulary import Vocabulary

MAX_SENT_FEATURES = 500
SECOND_NS = 1_000_000_000


class Bodies:
    """Makes the bodies of one run; map points are numbered through it."""

    def __init__(self, options: Options, left_out: LeftOut) -> None:
        self._options, self._left_out = options, left_out
        self._vocabulary = Vocabulary.shipped()
        self._globals = GlobalDescriptors(options.global_model) if options.global_model else None
        self._next_point = 0
        # Landmarks whose place was sent, by session: it is sent once.
        self._placed: dict[str, set[int]] = {}

    def of(self, index: int, tracked: Tracked, view: View, signs: list[Sign]) -> dict[str, Any]:
        """Return the body of the keyframe of the `index`-th photograph."""
        frame, options, pose = tracked.frame, self._options, tracked.session_from_camera
        depths_m = None
        with self._left_out.part("; no distances are measured by it"):
            depths_m = frame.depths_m(tracked.camera)
        ranges = Ranges(frame, tracked.camera, options.letter_height_m, depths_m)
        # Where photographs carry no time that can be trusted: one a second, in order.
        stamp_ns = frame.stamp_ns if frame.stamp_ns is not None else (index + 1) * SECOND_NS
        body: dict[str, Any] = {
            "session": tracked.session,
            "stamp": {"sec": stamp_ns // SECOND_NS, "nanosec": stamp_ns % SECOND_NS},
            "pose": {"translation": _vector(pose[:3, 3]), "rotation": quaternion(pose[:3, :3])},
            "camera": tracked.camera.body(),
            "bow": self._vocabulary.bag(tracked.features.descriptors),
            "covisible": tracked.covisible,
        }
        if self._globals is not None:
            body["global_descriptor"] = self._globals.of(view.turn.seen(view.image))
        if frame.landmarks is not None:
            body |= self._landmarks(tracked)
        if signs:
            body["detections"] = [detection(sign, view, tracked.camera, pose, ranges, options.crops) for sign in signs]
        if options.features and len(tracked.features):
            body["features"] = tracked.features.body(MAX_SENT_FEATURES)
            if frame.depth is not None and frame.session_from_camera is not None:
                self._add_points(body, tracked, ranges)
        return body

    def _landmarks(self, tracked: Tracked) -> dict[str, Any]:
        landmarks = tracked.frame.landmarks
        assert landmarks is not None
        placed = self._placed.setdefault(tracked.session, set())
        new = [at for at, id in enumerate(landmarks.ids) if int(id) not in placed]
        placed.update(int(id) for id in landmarks.ids)
        return {
            "map_points": {
                "ids": [int(landmarks.ids[at]) for at in new],
                "positions": [_list(landmarks.positions[at]) for at in new],
            },
            "observes": [int(id) for id in landmarks.ids],
        }

    def _add_points(self, body: dict[str, Any], tracked: Tracked, ranges: Ranges) -> None:
        """Add the map point of each feature that has a depth."""
        points = ranges.points(tracked.features.keypoints[:MAX_SENT_FEATURES, :2])
        pose = tracked.session_from_camera
        is_known = ~np.isnan(points[:, 2])
        ids = np.where(is_known, self._next_point + np.cumsum(is_known) - 1, -1)
        self._next_point += int(is_known.sum())
        positions = [_list(pose[:3, :3] @ point + pose[:3, 3]) for point in points[is_known]]
        body["features"]["map_points"] = ids.tolist()
        body["map_points"] = {"ids": ids[is_known].tolist(), "positions": positions}


def _list(point: np.ndarray) -> list[float]:
    # 0.0 is added so that no -0.0 is written.
    return [round(float(value), 5) + 0.0 for value in point]


def _vector(point: np.ndarray) -> dict[str, float]:
    return {axis: round(float(value), 6) + 0.0 for axis, value in zip("xyz", point)}
