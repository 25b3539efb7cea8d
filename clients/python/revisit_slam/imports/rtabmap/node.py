"""Node of RTAB-Map, from its database or a message, as an observation.

RTAB-Map's poses, links and three-dimensional points are of the robot's base. The API's are of the camera:
`map_from_camera = map_from_base @ base_from_camera`, and a point at `p` of the base is at `map_from_base @ p`.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np

from ...pixels.pinhole import Pinhole
from ..observation import NO_POINT, SECOND_NS, Features, Observation, nanoseconds_of
from ..poses import moved

# A node's points are its own: their numbers have room for so many.
POINTS_A_NODE = 1 << 20
MAX_WORD = 2**32 - 1
# The server takes descriptors of a multiple of eight bytes, up to 512.
DESCRIPTOR_STEP, MAX_DESCRIPTOR_BYTES = 8, 512


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


def observation(
    names: tuple[str, str], node: int, stamp_ns: int, map_from_base: np.ndarray, mounted: Mounted, words: Words, vocabulary: str
) -> Observation:
    """Return a node as an observation; `names` are its id and its session."""
    counted = Counter(int(word) for word in words.ids if 0 < word <= MAX_WORD)
    features, placed = _features(node, map_from_base, mounted, words)
    return Observation(
        *names, stamp_ns, map_from_base @ mounted.base_from_camera, mounted.camera,
        words=counted, vocabulary=vocabulary, features=features, placed=placed,
        covisible={},  # The links of the graph say which: they follow.
    )  # fmt: skip


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


def stamp_of(seconds: object, node: int) -> int:
    """Return a node's time in nanoseconds; where nothing tells it, a second a node."""
    known = isinstance(seconds, (int, float)) and seconds > 0
    return (nanoseconds_of(seconds) if known else None) or node * SECOND_NS  # type: ignore[arg-type]


def usable_descriptors(rows: np.ndarray | None) -> np.ndarray | None:
    """Return descriptors if they are binary and of a length that the server takes."""
    if rows is None or rows.dtype != np.uint8 or rows.ndim != 2:
        return None
    return rows if rows.shape[1] % DESCRIPTOR_STEP == 0 and 0 < rows.shape[1] <= MAX_DESCRIPTOR_BYTES else None
