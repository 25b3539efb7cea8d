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
from revisit_slam.pixels.training import train_vocabulary  # noqa: E402
from revisit_slam.pixels.vocabulary import SHIPPED  # noqa: E402


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
    made = train_vocabulary(documents)
    arrays = {f"level_{number}": level for number, level in enumerate(made.levels)}
    np.savez_compressed(chosen.output, weights=made.weights, **arrays)
    print(f"{made.fingerprint}: {len(documents)} photographs, {chosen.output.stat().st_size} bytes")


if __name__ == "__main__":
    main()
