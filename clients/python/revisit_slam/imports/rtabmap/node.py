"""Node of RTAB-Map, from its database or a message, as an observation.

RTAB-Map's poses, links and three-dimensional points are of the robot's base. The API's are of the camera:
`map_from_camera = map_from_base @ base_from_camera`, and a point at `p` of the base is at `map_from_base @ p`.
"""

from __future__ import annotations

from collections import Counter, OrderedDict
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...pixels.pinhole import Pinhole
from ..observation import NO_POINT, SECOND_NS, Features, Observation, nanoseconds_of
from ..poses import inverse, moved

# A node's points are its own: their numbers have room for so many.
POINTS_A_NODE = 1 << 20
MAX_WORD = 2**32 - 1
# The server takes descriptors of a multiple of eight bytes, up to 512.
DESCRIPTOR_STEP, MAX_DESCRIPTOR_BYTES = 8, 512
# The words of so many nodes are at hand; with those further back a node shares none that are counted.
NODES_AT_HAND = 4096
# Links of its graph, by their types.
NEIGHBOUR, GLOBAL_CLOSURE, LOCAL_SPACE_CLOSURE, LOCAL_TIME_CLOSURE, USER_CLOSURE, NEIGHBOUR_MERGED = 0, 1, 2, 3, 4, 6
# From a node to a tag that it saw, whose number is negative there.
LANDMARK = 8
# Proximity links are of places that odometry knows to be near: no loop was detected.
COVISIBLE = {NEIGHBOUR, LOCAL_SPACE_CLOSURE, LOCAL_TIME_CLOSURE, NEIGHBOUR_MERGED}
LOOPS = {GLOBAL_CLOSURE, USER_CLOSURE}
CLASS = "landmark"
# Where nothing tells how large a tag is; only its box in the picture depends on it.
ASSUMED_SIDE_M = 0.16
# Links of consecutive nodes.
CONSECUTIVE = {NEIGHBOUR, NEIGHBOUR_MERGED}
# Beyond nodes that are no keyframes, so many are joined: the last ones.
MAX_BEYOND = 8
NEAREST_M = 0.05


@dataclass(frozen=True, eq=False)
class Words:
    """Words of a node: in parallel, the word's number, pixel, octave, angle in degrees, and place in the base (NaN: none)."""

    ids: np.ndarray
    pixels: np.ndarray
    octaves: np.ndarray
    angles_deg: np.ndarray
    points_in_base: np.ndarray
    descriptors: np.ndarray | None
    """Bytes, a row a word; None where they are floats, which no Hamming distance compares, or missing."""


@dataclass(frozen=True, eq=False)
class Mounted:
    """A node's first camera, where it sits on the base, and how many cameras stand side by side in its pictures."""

    camera: Pinhole | None
    base_from_camera: np.ndarray
    cameras: int = 1


# Landmarks that a node saw: their numbers, `base_from_landmark`, and their sides in metres.
Landmarks = list[tuple[int, np.ndarray, float]]


def observation(
    session: str, node: int, seconds: object, map_from_base: np.ndarray, mounted: Mounted, words: Words, landmarks: Landmarks
) -> Observation:
    """Return a node as an observation; each start of RTAB-Map is a session of its own."""
    # Where nothing tells the time, a second a node.
    stamp_ns = nanoseconds_of(seconds) if isinstance(seconds, (int, float)) and seconds > 0 else node * SECOND_NS
    features, placed = _features(node, map_from_base, mounted, words)
    return Observation(
        f"{session}-{node}", session, stamp_ns, map_from_base @ mounted.base_from_camera, mounted.camera,
        words=Counter(int(word) for word in words.ids if 0 < word <= MAX_WORD),
        vocabulary=f"rtabmap:{session.rpartition('-')[0]}",
        features=features, placed=placed, detections=_detections(landmarks, map_from_base, mounted),
        covisible={},  # The links of the graph say which: they follow.
    )  # fmt: skip


class Nodes:
    """The nodes so far: the names of their keyframes, and the words of the last ones.

    Neighbours of a node that is no keyframe, such as those between keyframes, are neighbours of each other.
    """

    def __init__(self) -> None:
        self.names: dict[int, str] = {}
        # Of a node that is no keyframe: the keyframes before it.
        self._before: dict[int, tuple[int, ...]] = {}
        self._words: OrderedDict[int, np.ndarray] = OrderedDict()

    def join(self, node: int, seen: Observation, links: Iterable[tuple[int, int]]) -> None:
        """Add a node, and tell its observation which earlier ones it is linked with (node, type)."""
        words = np.fromiter(seen.words or (), np.int64)
        for other, kind in links:
            if other in self.names and kind in LOOPS:
                seen.loops.append(self.names[other])
            elif kind in COVISIBLE:
                for near in self._reached(other, kind):
                    seen.covisible[self.names[near]] = len(np.intersect1d(words, self._words.get(near, ()), assume_unique=True))
        self.names[node] = seen.id
        self._words[node] = words
        if len(self._words) > NODES_AT_HAND:
            self._words.popitem(last=False)

    def leave_out(self, node: int, links: Iterable[tuple[int, int]]) -> None:
        """Add a node that is no keyframe."""
        before = {near for other, kind in links if kind in CONSECUTIVE for near in self._reached(other, kind)}
        self._before[node] = tuple(sorted(before)[-MAX_BEYOND:])

    def _reached(self, other: int, kind: int) -> tuple[int, ...]:
        if other in self.names:
            return (other,)
        return self._before.get(other, ()) if kind in CONSECUTIVE else ()


def _features(node: int, map_from_base: np.ndarray, mounted: Mounted, words: Words) -> tuple[Features | None, dict[int, np.ndarray]]:
    """Return the features of the first camera, and where those are that have a point."""
    if words.descriptors is None or not len(words.ids) or mounted.camera is None:
        return None, {}
    # Pictures of several cameras stand side by side: the first one's pixels are the leftmost.
    of_first = np.ones(len(words.ids), bool) if mounted.cameras == 1 else words.pixels[:, 0] < mounted.camera.width
    kept = np.flatnonzero(of_first)[:POINTS_A_NODE]
    placed = np.isfinite(words.points_in_base[kept]).all(axis=1)
    ids = np.where(placed, node * POINTS_A_NODE + kept, NO_POINT)
    features = Features(
        words.pixels[kept], words.octaves[kept], words.angles_deg[kept], words.descriptors[kept], ids
    ).usable()  # fmt: skip
    sent = features.points[features.points >= 0]
    positions = moved(map_from_base, words.points_in_base[sent - node * POINTS_A_NODE].astype(float))
    return features, dict(zip((int(id) for id in sent), positions))


def _detections(landmarks: Landmarks, map_from_base: np.ndarray, mounted: Mounted) -> list[dict[str, Any]]:
    """Return the landmarks in front of a camera as detections of the API."""
    found, camera = [], mounted.camera
    for number, base_from_landmark, side_m in landmarks:
        in_base = base_from_landmark[:3, 3]
        x, y, z = moved(inverse(mounted.base_from_camera), in_base[None])[0]
        if camera is None or not z > NEAREST_M:
            continue
        u, v = camera.fx * x / z + camera.cx, camera.fy * y / z + camera.cy
        half = side_m / 2 * camera.fx / z
        found.append(
            {
                "class": CLASS,
                "confidence": 1.0,
                "box": [float(value) for value in (u - half, v - half, u + half, v + half)],
                "position": [float(value) for value in moved(map_from_base, in_base[None])[0]],
                "text": str(abs(number)),
            }
        )
    return found


def without_features(mounted: Mounted, words: Words) -> str | None:
    """Return why a node with words has no features, if it has none."""
    if not len(words.ids) or (words.descriptors is not None and mounted.camera is not None):
        return None
    return "no size of its camera" if words.descriptors is not None else "no binary descriptors, or none of a length that is taken"


def usable_descriptors(rows: np.ndarray | None) -> np.ndarray | None:
    """Return descriptors if they are binary and of a length that the server takes."""
    if rows is None or rows.dtype != np.uint8 or rows.ndim != 2:
        return None
    return rows if rows.shape[1] % DESCRIPTOR_STEP == 0 and 0 < rows.shape[1] <= MAX_DESCRIPTOR_BYTES else None
