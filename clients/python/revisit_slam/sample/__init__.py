"""A small building to try the package on: rendered corridors that look alike."""

from .building import draw

__all__ = ["draw"]
