"""Options: what decides how photographs become keyframes."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from .ranges import LETTER_HEIGHT_M


@dataclass(frozen=True)
class Options:
    """What decides how photographs become keyframes."""

    every_frame: bool = False
    features: bool = False
    global_model: str | None = None
    crops: bool = True
    focal_px: float | None = None
    letter_height_m: float = LETTER_HEIGHT_M
    cache: Path | None = None
    threads: int = 1
