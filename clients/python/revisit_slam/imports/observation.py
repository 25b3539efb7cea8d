"""Observation: one keyframe of another system's map, and its body as the API takes it."""

from __future__ import annotations

import base64
from collections import Counter
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..errors import RevisitError
from ..packing import packed
from ..pixels.pinhole import MAX_PIXEL, Pinhole
from .limits import MAX_COVISIBLE, MAX_DETECTIONS, MAX_FEATURES, MAX_OBSERVED_POINTS
from .poses import body as pose_body

SECOND_NS = 1_000_000_000
NO_POINT = -1
# What the server takes: seconds of the years that a calendar prints, levels of a pyramid.
MAX_STAMP_S = 253_402_300_799
MAX_OCTAVE = 63


def nanoseconds_of(seconds: float) -> int:
    """Return a time in nanoseconds, or say that the server takes no such time."""
    # Not `>`: a number that is none is above nothing.
    if not abs(seconds) <= MAX_STAMP_S:
        raise RevisitError(f"its time {seconds:g} s is none")
    return round(seconds * SECOND_NS)


@dataclass(frozen=True, eq=False)
class Features:
    """Binary features, row by row: pixels, octaves, angles in degrees, descriptors, and the map point of each or -1."""

    pixels: np.ndarray
    octaves: np.ndarray
    angles_deg: np.ndarray
    descriptors: np.ndarray
    points: np.ndarray

    def usable(self) -> Features:
        """Return those that the server takes, in their order, and at most as many as it takes."""
        good = np.isfinite(self.pixels).all(axis=1) & (np.abs(self.pixels) <= MAX_PIXEL).all(axis=1)
        kept = np.flatnonzero(good)[:MAX_FEATURES]
        octaves = self.octaves[kept]
        # OpenCV packs layer and scale into the octave of some detectors; that is no level.
        octaves = np.where((octaves >= 0) & (octaves <= MAX_OCTAVE), octaves, 0)
        angles = self.angles_deg[kept]
        angles = np.where(np.isfinite(angles) & (np.abs(angles) <= 360), angles, 0)
        return Features(self.pixels[kept], octaves, angles, self.descriptors[kept], self.points[kept])

    def body(self) -> dict[str, Any]:
        """Return them as the API takes them."""
        return {
            "descriptor_bytes": int(self.descriptors.shape[1]),
            "descriptors": base64.b64encode(np.ascontiguousarray(self.descriptors, np.uint8).tobytes()).decode(),
            "keypoints": [
                [float(u), float(v), int(octave), float(angle)]
                for (u, v), octave, angle in zip(self.pixels, self.octaves, self.angles_deg)
            ],
            "map_points": [int(id) for id in self.points],
        }


@dataclass(frozen=True, eq=False)
class Observation:
    """A keyframe: where it was, and what it saw."""

    id: str
    session: str
    stamp_ns: int
    session_from_camera: np.ndarray
    camera: Pinhole | None = None
    words: Counter[int] | None = None
    """How often each word occurs."""
    vocabulary: str | None = None
    features: Features | None = None
    observes: list[int] = field(default_factory=list)
    placed: dict[int, Any] = field(default_factory=dict)
    """Positions of the map points that no earlier keyframe placed, in the session's frame."""
    covisible: dict[str, int] | None = None
    """Earlier keyframes that the system itself joins with this one, and how much they share; None where it does not say."""
    loops: list[str] = field(default_factory=list)
    """Earlier keyframes to which the system closed a loop from this one."""
    detections: list[dict[str, Any]] = field(default_factory=list)

    def __post_init__(self) -> None:
        # Before any later keyframe can name it, or count on the points that it places.
        if len(self.observes) > MAX_OBSERVED_POINTS:
            raise RevisitError(f"it observes {len(self.observes)} map points; at most {MAX_OBSERVED_POINTS} are taken")

    def body(self) -> dict[str, Any]:
        """Return the body of its `PUT`."""
        body: dict[str, Any] = {
            "session": self.session,
            "stamp": {"sec": self.stamp_ns // SECOND_NS, "nanosec": self.stamp_ns % SECOND_NS},
            "pose": pose_body(self.session_from_camera),
        }
        if self.camera is not None:
            body["camera"] = self.camera.body()
        if self.words:
            body["bow"] = {"words": sorted(self.words), "weights": [float(self.words[word]) for word in sorted(self.words)]}
            if self.vocabulary:
                body["bow"]["vocabulary"] = self.vocabulary
        if self.features is not None and len(self.features.points):
            body["features"] = self.features.body()
        if self.placed:
            body["map_points"] = {
                "ids": list(self.placed), "positions": [[float(value) for value in self.placed[id]] for id in self.placed]
            }
        if self.observes:
            body["observes"] = self.observes
        if self.covisible is not None:
            most = sorted(self.covisible.items(), key=lambda item: (-item[1], item[0]))[:MAX_COVISIBLE]
            body["covisible"] = [{"keyframe": id, "shared": shared} for id, shared in sorted(most)]
        if self.detections:
            body["detections"] = self.detections[:MAX_DETECTIONS]
        return packed(body)
