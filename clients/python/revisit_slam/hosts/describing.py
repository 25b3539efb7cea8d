"""Describing: words and features of a picture, by the package's own ORB and vocabulary. Needs OpenCV."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np

from ..imports.observation import NO_POINT
from ..imports.poses import moved
from ..pixels.features import features_of
from ..pixels.pinhole import Pinhole
from ..pixels.ranges import points_at
from ..pixels.vocabulary import Vocabulary

MAX_SENT_FEATURES = 500


class Describer:
    """Makes words of all features, and sends the strongest."""

    def __init__(self) -> None:
        self._vocabulary = Vocabulary.shipped()

    def __call__(
        self, picture: np.ndarray, depth_m: np.ndarray | None, camera: Pinhole, map_from_camera: np.ndarray, first_point: int
    ) -> dict[str, Any]:
        """Return `bow` and `features`, and where there is depth `map_points`."""
        bgr = cv2.cvtColor(picture, cv2.COLOR_GRAY2BGR) if picture.ndim == 2 else np.ascontiguousarray(picture[:, :, ::-1])
        found = features_of(bgr)
        if not len(found):
            return {}
        kept = found.keypoints[:MAX_SENT_FEATURES]
        # In 32 bits each, so that they can be packed.
        keypoints = [[float(np.float32(u)), float(np.float32(v)), int(o), float(np.float32(a))] for u, v, o, a in kept]
        features = found.body(MAX_SENT_FEATURES) | {"keypoints": keypoints}
        body: dict[str, Any] = {"bow": self._vocabulary.bag(found.descriptors), "features": features}
        if depth_m is not None:
            points = points_at(kept[:, :2], camera, depth_m)
            is_known = np.isfinite(points[:, 2])
            ids = np.where(is_known, first_point + np.arange(len(points)), NO_POINT)
            features["map_points"] = ids.tolist()
            body["map_points"] = {"ids": ids[is_known].tolist(), "positions": moved(map_from_camera, points[is_known]).tolist()}
        return body
