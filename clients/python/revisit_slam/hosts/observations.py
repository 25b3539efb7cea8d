"""Any SLAM, live: poses, pictures and detections come in, edges of a pose graph go out."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..imports.observation import Observation
from ..imports.poses import apart
from ..imports.rtabmap.messages import camera_of, pose_of
from ..pixels.pinhole import Pinhole
from .bridge import Bridge
from .loops import Edge, Loop, Trust, edge_of
from .pictures import depth_of, picture_of
from .sightings import Reading, detections_of
from .stamped import Together, stamp_ns

# Moments whose loops may still come.
MAX_REMEMBERED = 100_000


# Takes a picture, its depth in metres or None, the camera, `map_from_camera`, and the number of the first map point.
Describe = Callable[[np.ndarray, np.ndarray | None, Pinhole, np.ndarray, int], dict[str, Any]]
# A keyframe's points are its own.
POINTS_A_KEYFRAME = 1 << 16


@dataclass(frozen=True, eq=False)
class Setup:
    """How a robot is built, and when a moment is worth a keyframe."""

    session: str
    base_from_camera: np.ndarray = field(default_factory=lambda: np.eye(4))
    """Poses are of the base; the identity where they are of the camera."""
    slop_s: float = 0.05
    keyframe_distance_m: float = 0.25
    keyframe_turn_rad: float = 0.26
    reading: Reading = Reading()
    trust: Trust = Trust()
    has_depth: bool = False
    """Whether depth images, registered to the pictures, come on a topic of their own: then features have map points."""
    describe: Describe | None = None
    """Makes words and features of a picture; called in the bridge's thread."""


class ObservationsBridge:
    """Joins one robot and one map of the server. Its methods return at once, and may be called by any executor."""

    def __init__(self, bridge: Bridge, setup: Setup) -> None:
        self._bridge, self._setup = bridge, setup
        topics = ("detections", "image", "pose", *(("depth",) if setup.has_depth else ()))
        self._together = Together(topics, setup.slop_s)
        self._count = 0
        self._camera: Pinhole | None = None
        self._last: tuple[str, np.ndarray] | None = None
        self._stamps: OrderedDict[str, int] = OrderedDict()
        self.without_camera = 0

    def on_camera_info(self, message: Any) -> None:
        """Take a `CameraInfo`."""
        self._bridge.leave(lambda: self._camera_info(message))

    def on_pose(self, message: Any) -> None:
        """Take a `PoseStamped` of the base."""
        self._bridge.leave(lambda: self._add("pose", message))

    def on_image(self, message: Any) -> None:
        """Take an `Image`, undistorted."""
        self._bridge.leave(lambda: self._add("image", message))

    def on_depth(self, message: Any) -> None:
        """Take a depth image, registered to the picture."""
        self._bridge.leave(lambda: self._add("depth", message))

    def on_detections(self, message: Any) -> None:
        """Take a `Detection2DArray`; one without detections is a moment too."""
        self._bridge.leave(lambda: self._add("detections", message))

    def take_loops(self) -> list[tuple[Loop, Edge | None]]:
        """Return the loops found since the last call; an edge where the transform is measured and both ends are of this run."""
        found, place = [], self._setup.base_from_camera
        for loop in self._bridge.take_loops():
            query, candidate = self._stamps.get(loop.query), self._stamps.get(loop.candidate)
            edge = None
            if query is not None and candidate is not None:
                edge = edge_of(loop, (query, candidate), place, place, self._setup.trust)
            found.append((loop, edge))
        return found

    def _camera_info(self, message: Any) -> None:
        self._camera = camera_of(message, "CameraInfo") or self._camera

    def _add(self, topic: str, message: Any) -> None:
        for moment_ns, found in self._together.add(topic, stamp_ns(message.header), message):
            self._moment(moment_ns, found)

    def _covisible(self) -> dict[str, int] | None:
        # The server knows that two keyframes one after the other see much of the same, but where they have map points, which
        # here are each keyframe's own.
        if self._setup.describe is None:
            return None
        return {self._last[0]: 1} if self._last is not None else {}

    def _moment(self, moment_ns: int, found: dict[str, Any]) -> None:
        if self._camera is None:
            self.without_camera += 1
            return
        pose = pose_of(found["pose"].pose, "PoseStamped") @ self._setup.base_from_camera
        if self._last is not None:
            distance_m, turn_rad = apart(self._last[1], pose)
            if distance_m < self._setup.keyframe_distance_m and turn_rad < self._setup.keyframe_turn_rad:
                return
        picture = picture_of(found["image"])
        id = f"{self._setup.session}-{moment_ns}"
        seen = Observation(
            id, self._setup.session, moment_ns, pose, self._camera,
            covisible=self._covisible(),
            detections=detections_of(found["detections"].detections, self._camera, pose, picture, self._setup.reading),
        )  # fmt: skip
        body = seen.body()
        if self._setup.describe is not None:
            depth_m = depth_of(found["depth"]) if self._setup.has_depth else None
            body |= self._setup.describe(picture, depth_m, self._camera, pose, self._count * POINTS_A_KEYFRAME)
            self._count += 1
        if self._bridge.send(id, body):
            self._last = (id, pose)
            self._stamps[id] = moment_ns
            if len(self._stamps) > MAX_REMEMBERED:
                self._stamps.popitem(last=False)
