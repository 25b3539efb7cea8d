#!/usr/bin/env python3
"""Prints how often the nearest global descriptor names the right floor, over photographs with known floors.

`tools/global_evidence.py FOLDER TABLE`: FOLDER holds the photographs, TABLE is a CSV file with the columns frame, floor and split
(`query` or `gallery`). A video is the part of a frame's name before `_frame_`, and its frames are numbered by seconds. Protocol A asks
against the whole gallery, B without the frames of the query's video within 2 s, C without its video. The distorted queries are
synthetic: a fixed change of light, sharpness or framing of the same photographs, asked by protocol A, where the frames beside them
are in the gallery.
"""

from __future__ import annotations

import csv
import sys
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from revisit_slam.pixels.global_descriptors import GlobalDescriptors  # noqa: E402


def _gamma(exponent: float) -> Callable[[np.ndarray], np.ndarray]:
    table = np.rint(255 * (np.arange(256) / 255) ** exponent).astype(np.uint8)
    return lambda image: table[image]


def _cropped(image: np.ndarray) -> np.ndarray:
    height, width = image.shape[:2]
    return image[height // 10 : height - height // 10, width // 10 : width - width // 10]


DISTORTIONS: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "darker (gamma 2)": _gamma(2.0),
    "lighter (gamma 0.5)": _gamma(0.5),
    "warm light (blue x 0.6)": lambda image: (image * np.array([0.6, 1, 1])).astype(np.uint8),
    "blurred (sigma 6 px)": lambda image: cv2.GaussianBlur(image, (0, 0), 6),
    "cropped to 80 %": _cropped,
}


def main(folder: Path, table: Path) -> None:
    """Print the shares of queries whose nearest photograph, and any of whose five nearest, is of their floor."""
    with table.open(newline="") as file:
        rows = list(csv.DictReader(file))
    model = GlobalDescriptors("ppocr-det")

    def vectors(of: list[dict[str, str]], change: Callable[[np.ndarray], np.ndarray] = lambda image: image) -> np.ndarray:
        found = np.array([model.numbers(change(cv2.imread(str(folder / row["frame"])))) for row in of], dtype=np.float64)
        return found / np.linalg.norm(found, axis=1, keepdims=True)

    queries, gallery = ([row for row in rows if row["split"] == split] for split in ("query", "gallery"))
    video = [np.array([row["frame"].split("_frame_")[0] for row in part]) for part in (queries, gallery)]
    second = [np.array([int(Path(row["frame"]).stem.split("_frame_")[1]) for row in part]) for part in (queries, gallery)]
    floor = [np.array([row["floor"] for row in part]) for part in (queries, gallery)]
    same = video[0][:, None] == video[1][None]
    near = same & (np.abs(second[0][:, None] - second[1][None]) <= 2)
    asked, stored = vectors(queries), vectors(gallery)
    print(f"{len(queries)} queries, {len(gallery)} photographs in the gallery, {len(set(floor[1]))} floors")
    print(f"{'':28}{'top-1':>8}{'top-5':>8}")

    def show(name: str, queries: np.ndarray, left_out: np.ndarray) -> None:
        scores = np.where(left_out, -2.0, queries @ stored.T)
        best = np.argsort(-scores, axis=1, kind="stable")[:, :5]
        right = floor[1][best] == floor[0][:, None]
        print(f"{name:28}{100 * right[:, 0].mean():7.1f}%{100 * right.any(axis=1).mean():7.1f}%")

    for name, left_out in (("A", np.zeros_like(same)), ("B", near), ("C", same)):
        show(name, asked, left_out)
    for name, change in DISTORTIONS.items():
        show(f"A, {name}", vectors(queries, change), np.zeros_like(same))


if __name__ == "__main__":
    cv2.setNumThreads(1)
    main(Path(sys.argv[1]), Path(sys.argv[2]))
