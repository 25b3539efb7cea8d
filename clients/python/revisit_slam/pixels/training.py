"""Training of a vocabulary: a k-majority tree over binary descriptors, and the inverse document frequency of its leaves."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .vocabulary import Vocabulary

BRANCHING = 10
DEPTH = 4
OF_EACH = 200
ROUNDS = 8


def train_vocabulary(documents: Sequence[np.ndarray]) -> Vocabulary:
    """Return the vocabulary of photographs, each given by its descriptors (n x 32). The same ones give the same bytes.

    Some descriptors of each photograph shape the tree; all of them count for the weights.
    """
    rng = np.random.default_rng(0)
    sample = [part[rng.permutation(len(part))[:OF_EACH]] for part in documents if len(part)]
    bits = np.unpackbits(np.concatenate(sample), axis=1).astype(np.float32) * 2 - 1
    vocabulary = Vocabulary(_tree(bits), np.ones(BRANCHING**DEPTH, np.float32))
    seen = np.zeros(BRANCHING**DEPTH)
    for part in documents:
        seen[np.unique(vocabulary.words(part))] += 1
    # A word that no photograph had is as rare as one that a single one had.
    weights = np.log(len(documents) / np.maximum(seen, 1)).astype(np.float32)
    return Vocabulary(vocabulary.levels, weights)


def _tree(bits: np.ndarray) -> list[np.ndarray]:
    """Return the centres of each level, packed into bytes."""
    rng = np.random.default_rng(0)
    node, levels = np.zeros(len(bits), int), []
    for level in range(DEPTH):
        centres = []
        following = np.zeros(len(bits), int)
        # Members of a node in one stretch each: finding them node by node would read all descriptors each time.
        order = np.argsort(node, kind="stable")
        ends = np.searchsorted(node[order], np.arange(BRANCHING**level + 1))
        for parent in range(BRANCHING**level):
            members = order[ends[parent] : ends[parent + 1]]
            found, mine = _split(bits[members], rng)
            centres.append(found)
            following[members] = parent * BRANCHING + mine
        levels.append(np.packbits(np.concatenate(centres) > 0, axis=1))
        node = following
    return levels


def _split(bits: np.ndarray, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Return the centres of k clusters of descriptors (rows of +1 and -1), and each row's cluster."""
    if len(bits) == 0:
        return np.ones((BRANCHING, bits.shape[1]), np.int8), np.zeros(0, int)
    centres = bits[rng.choice(len(bits), BRANCHING, replace=len(bits) < BRANCHING)].astype(np.float32)
    for _ in range(ROUNDS):
        mine = (bits @ centres.T).argmax(axis=1)
        for cluster in range(BRANCHING):
            members = bits[mine == cluster]
            if len(members):
                centres[cluster] = np.where(members.sum(axis=0) >= 0, 1, -1)
    return centres.astype(np.int8), (bits @ centres.T).argmax(axis=1)
