"""Image of a COLMAP model, as both of its forms give it."""

from __future__ import annotations

from dataclasses import dataclass


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
