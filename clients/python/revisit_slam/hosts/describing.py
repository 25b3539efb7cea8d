"""Describing: words and features of a picture, by the package's own ORB and vocabulary. Needs OpenCV."""

from __future__ import annotations

import base64
from typing import Any

import cv2
import numpy as np

from ..imports.observation import NO_POINT, Pinhole
from ..imports.poses import moved
from ..pixels.features import features_of
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
        body: dict[str, Any] = {
            "bow": self._vocabulary.bag(found.descriptors),
            "features": {
                "descriptor_bytes": 32,
                "descriptors": base64.b64encode(found.descriptors[:MAX_SENT_FEATURES].tobytes()).decode(),
                "keypoints": [[float(np.float32(u)), float(np.float32(v)), int(o), float(np.float32(a))] for u, v, o, a in kept],
            },
        }
        return body if depth_m is None else body | _points(body["features"], kept, depth_m, camera, map_from_camera, first_point)


def _points(
    features: dict[str, Any], kept: np.ndarray, depth_m: np.ndarray, camera: Pinhole, map_from_camera: np.ndarray, first_point: int
) -> dict[str, Any]:
    """Return the map point of each feature with a depth, and name it in the features."""
    columns, rows = np.rint(kept[:, :2]).astype(int).T
    inside = (columns >= 0) & (rows >= 0) & (columns < depth_m.shape[1]) & (rows < depth_m.shape[0])
    depths = np.where(inside, depth_m[rows.clip(0, depth_m.shape[0] - 1), columns.clip(0, depth_m.shape[1] - 1)], 0.0)
    rays = np.column_stack(((kept[:, 0] - camera.cx) / camera.fx, (kept[:, 1] - camera.cy) / camera.fy, np.ones(len(kept))))
    known = np.flatnonzero(depths > 0)
    features["map_points"] = [first_point + at if depth > 0 else NO_POINT for at, depth in enumerate(depths)]
    positions = moved(map_from_camera, rays[known] * depths[known, None])
    return {"map_points": {"ids": [first_point + int(at) for at in known], "positions": positions.tolist()}}
