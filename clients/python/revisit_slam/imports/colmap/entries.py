"""Entries of a COLMAP model, as both of its forms give them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple, Protocol

import numpy as np

from ..damage import Account
from ..observation import Pinhole


class Camera(NamedTuple):
    """A camera: its pinhole, None for one that sees all around, and whether it distorts."""

    pinhole: Pinhole | None
    distorts: bool


@dataclass(frozen=True, eq=False)
class Image:
    """An image: its name and pose, and where its points stand in the file."""

    name: str
    camera: int
    wxyz: tuple[float, float, float, float]
    """Rotation of `camera_from_world`, real part first, as COLMAP writes it."""
    camera_from_world: tuple[float, float, float]
    """Its translation."""
    offset: int
    observations: int
    """How many features it has; unknown (0) in the text form."""


class ModelFiles(Protocol):
    """The three files of a model, read piece by piece: none of them is ever in memory."""

    def cameras(self, account: Account) -> dict[int, Camera]:
        """Return the cameras by their ids; one that is wrong is left out."""

    def points(self) -> Iterator[tuple[int, float, float, float]]:
        """Yield the points: id, x, y, z."""

    def images(self) -> Iterator[Image]:
        """Yield the images in the order of the file."""

    def observed(self, image: Image) -> np.ndarray:
        """Return the ids of the points that an image observes, feature by feature, with a sign; -1 where a feature has none."""

    def close(self) -> None:
        """Close the files."""


def model_file(model: Path, name: str, form: str) -> Path:
    """Return the path of one of a model's files."""
    return model / f"{name}.{form}"
