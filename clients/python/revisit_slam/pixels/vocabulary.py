"""Vocabulary: a tree of ORB descriptors that turns features into a bag of words."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from importlib import resources
from typing import Any

import numpy as np

SHIPPED = "vocabulary.npz"
_BITS = np.array([bin(byte).count("1") for byte in range(256)], np.uint8)


@dataclass(frozen=True)
class Vocabulary:
    """Centres of each level (level l has k**(l+1) of 32 bytes), and a weight for each leaf."""

    levels: list[np.ndarray]
    weights: np.ndarray

    @staticmethod
    def shipped() -> Vocabulary:
        """Return the vocabulary inside the package."""
        with resources.files(__package__).joinpath(SHIPPED).open("rb") as file, np.load(file) as arrays:
            count = sum(name.startswith("level_") for name in arrays.files)
            return Vocabulary([arrays[f"level_{level}"] for level in range(count)], arrays["weights"])

    @property
    def branching(self) -> int:
        """Children of a node."""
        return len(self.levels[0])

    @property
    def fingerprint(self) -> str:
        """Name of the vocabulary: equal words of two vocabularies mean nothing to each other."""
        digest = hashlib.sha256()
        for array in (*self.levels, self.weights):
            digest.update(np.ascontiguousarray(array).tobytes())
        return f"revisit-slam-{self.branching}x{len(self.levels)}-{digest.hexdigest()[:16]}"

    def words(self, descriptors: np.ndarray) -> np.ndarray:
        """Return the leaf of each descriptor."""
        node = np.zeros(len(descriptors), int)
        for level in self.levels:
            children = node[:, None] * self.branching + np.arange(self.branching)
            distances = _differing_bits(level[children], descriptors[:, None, :])
            node = children[np.arange(len(node)), distances.argmin(axis=1)]
        return node

    def bag(self, descriptors: np.ndarray) -> dict[str, Any]:
        """Return the bag of words as the API writes it: TF-IDF, L1-normalised."""
        words, counts = np.unique(self.words(descriptors), return_counts=True)
        weights = counts * self.weights[words]
        kept = weights > 0
        words, weights = words[kept], weights[kept]
        total = weights.sum()
        return {
            "words": [int(word) for word in words],
            "weights": [round(float(weight / total), 6) for weight in weights],
            "vocabulary": self.fingerprint,
        }


def _differing_bits(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Return how many bits differ along the last axis."""
    if hasattr(np, "bitwise_count"):  # From numpy 2 on, and five times faster.
        apart = np.bitwise_xor(*(np.ascontiguousarray(side).view(np.uint64) for side in (one, other)))
        return np.bitwise_count(apart).sum(axis=2, dtype=np.int32)
    return _BITS[one ^ other].sum(axis=2, dtype=np.int32)
