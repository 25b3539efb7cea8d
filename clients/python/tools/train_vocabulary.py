#!/usr/bin/env python3
"""Trains the vocabulary that the package ships, from photographs: `train_vocabulary.py FOLDER...`.

A k-majority tree over ORB descriptors (bits of a centre are the majority of its members'), and the inverse document
frequency of each leaf. Only numbers are kept. The same photographs give the same file.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import cv2
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from revisit_slam.pixels.features import features_of  # noqa: E402
from revisit_slam.pixels.frames import list_frames  # noqa: E402
from revisit_slam.pixels.vocabulary import SHIPPED, Vocabulary  # noqa: E402

BRANCHING = 10
DEPTH = 4
OF_EACH = 200
ROUNDS = 8


def split(bits: np.ndarray, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
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


def train(bits: np.ndarray) -> list[np.ndarray]:
    """Return the centres of each level, packed into bytes."""
    rng = np.random.default_rng(0)
    node, levels = np.zeros(len(bits), int), []
    for depth in range(DEPTH):
        centres = []
        following = np.zeros(len(bits), int)
        for parent in range(BRANCHING**depth):
            members = np.flatnonzero(node == parent)
            found, mine = split(bits[members], rng)
            centres.append(found)
            following[members] = parent * BRANCHING + mine
        levels.append(np.packbits(np.concatenate(centres) > 0, axis=1))
        node = following
    return levels


def main() -> None:
    """Train and write the file."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("-o", "--output", type=Path, default=Path(__file__).parents[1] / "revisit_slam/pixels" / SHIPPED)
    chosen = parser.parse_args()
    cv2.setNumThreads(1)
    documents = []
    for folder in chosen.folders:
        for frame in list_frames(folder):
            image = cv2.imread(str(frame.path), cv2.IMREAD_COLOR)
            if image is not None:
                documents.append(features_of(image).descriptors)
    rng = np.random.default_rng(0)
    sample = [part[rng.permutation(len(part))[:OF_EACH]] for part in documents if len(part)]
    bits = np.unpackbits(np.concatenate(sample), axis=1).astype(np.float32) * 2 - 1
    vocabulary = Vocabulary(train(bits), np.ones(BRANCHING**DEPTH, np.float32))
    seen = np.zeros(BRANCHING**DEPTH)
    for part in documents:
        seen[np.unique(vocabulary.words(part))] += 1
    # A word that no photograph had is as rare as one that a single one had.
    weights = np.log(len(documents) / np.maximum(seen, 1)).astype(np.float32)
    arrays = {f"level_{number}": level for number, level in enumerate(vocabulary.levels)}
    np.savez_compressed(chosen.output, weights=weights, **arrays)
    made = Vocabulary(vocabulary.levels, weights)
    print(f"{made.fingerprint}: {len(documents)} photographs, {len(bits)} descriptors, {chosen.output.stat().st_size} bytes")


if __name__ == "__main__":
    main()
