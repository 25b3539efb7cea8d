"""Ordinary ORB on the same photographs: the best by words, and the best by the inliers of a homography."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..ahead import ahead
from ..overlap import overlap
from ..vocabulary import Vocabulary
from .collection import Shot
from .protocols import PROTOCOLS, excluded
from .sights import Sight

# Photographs of the gallery that a homography is sought with, the best by words.
COMPARED = 30

Figures = list[tuple[str, str, float]]


class Ordinary:
    """Finds the most similar photograph of a gallery as image retrieval with ORB does."""

    def __init__(self, gallery: list[Sight], vocabulary: Vocabulary) -> None:
        self._gallery = gallery
        self._shots = [sight.shot for sight in gallery]
        self._vocabulary = vocabulary
        self._bags = np.stack([self._bag(sight) for sight in gallery])

    def figures(self, queries: list[Sight], threads: int, progress: Callable[[int], None]) -> Figures:
        """Return name, protocol and top-1: the share whose most similar photograph is on the right floor."""
        found = list(ahead(queries, self._right, threads, progress))
        names = ("ORB, best by words", f"ORB, most inliers of the {COMPARED} best by words")
        return [
            (name, protocol, sum(right[protocol][at] for right in found) / len(found))
            for at, name in enumerate(names)
            for protocol in PROTOCOLS
        ]

    def _right(self, query: Sight) -> dict[str, tuple[bool, bool]]:
        """Return for each protocol whether the best by words, and by inliers, are on the right floor."""
        # The L1 score of DBoW2: of two bags that each sum to 1, what they have in common.
        scores = np.minimum(self._bags, self._bag(query)).sum(axis=1)
        order = np.argsort(-scores, kind="stable")
        inliers: dict[int, int] = {}
        right = {}
        for protocol in PROTOCOLS:
            kept = [at for at in order if self._is_asked(protocol, query.shot, self._shots[at])][:COMPARED]
            for at in kept:
                if at not in inliers:
                    inliers[at] = overlap(query.tracking, self._gallery[at].tracking, query.camera).inliers
            firsts = (kept[:1], sorted(kept, key=lambda at: -inliers[at])[:1])
            by_words, by_inliers = (bool(first) and self._shots[first[0]].map == query.shot.map for first in firsts)
            right[protocol] = (by_words, by_inliers)
        return right

    def _is_asked(self, protocol: str, query: Shot, shot: Shot) -> bool:
        left_out = excluded(protocol, query, [shot])
        return shot.frame.id not in left_out.keyframes and shot.session not in left_out.sessions

    def _bag(self, sight: Sight) -> np.ndarray:
        words = np.bincount(self._vocabulary.words(sight.tracking.descriptors), minlength=len(self._vocabulary.weights))
        weighed = (words * self._vocabulary.weights).astype(np.float32)
        return weighed / max(float(weighed.sum()), 1e-9)
