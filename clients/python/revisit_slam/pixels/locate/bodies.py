"""Bodies: photographs as the API takes them, those of the gallery and those that ask."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..detections import detection
from ..ranges import LETTER_HEIGHT_M, Ranges
from ..signs import Sign
from ..tracking import Tracked, quaternion
from ..vocabulary import Vocabulary
from .gradients import Binariser
from .protocols import Excluded
from .sights import Sight

MAX_DETECTIONS = 64
PLACES = 5


class Bodies:
    """Makes the bodies of one run, with the words and the bits that the gallery gave."""

    def __init__(self, vocabulary: Vocabulary, binariser: Binariser, words: bool = True) -> None:
        self._vocabulary = vocabulary if words else None
        self._binariser = binariser

    def gallery(self, number: int, sight: Sight, tracked: Tracked, signs: list[Sign]) -> dict[str, Any]:
        """Return the `number`-th photograph of its video as a keyframe; it has turned with the pictures that it overlaps."""
        pose = tracked.session_from_camera
        return {
            "session": sight.shot.session,
            "stamp": {"sec": number + 1, "nanosec": 0},
            "pose": {"translation": {"x": 0.0, "y": 0.0, "z": 0.0}, "rotation": quaternion(pose[:3, :3])},
            "covisible": tracked.covisible,
            **self._seen(sight, signs, pose),
        }

    def question(self, sight: Sight, signs: list[Sign], maps: list[str], left_out: Excluded) -> dict[str, Any]:
        """Return the question where a photograph was taken; its signs are in the camera's frame."""
        keyframe = self._seen(sight, signs, np.eye(4))
        return {"keyframe": keyframe, "maps": maps, "exclude": left_out, "max": PLACES}

    def _seen(self, sight: Sight, signs: list[Sign], pose: np.ndarray) -> dict[str, Any]:
        ranges = Ranges(sight.shot.frame, sight.camera, LETTER_HEIGHT_M)
        # Crops are for models, which are not asked here.
        detections = [detection(sign, np.zeros((0, 0, 3), np.uint8), sight.camera, pose, ranges, False) for sign in signs]
        body: dict[str, Any] = {"camera": sight.camera.body(), "detections": detections[:MAX_DETECTIONS]}
        if sight.global_descriptor is not None:
            body["global_descriptor"] = sight.global_descriptor
        if self._vocabulary is not None and len(sight.words):
            body["bow"] = self._vocabulary.bag(sight.words.descriptors)
        features = self._binariser.features(sight.gradients)
        if len(features):
            body["features"] = features.body()
        return body
