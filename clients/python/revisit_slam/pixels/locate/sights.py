"""Sights: what is taken from each photograph, in threads, before anything is sent."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ...left_out import LeftOut
from ..ahead import ahead
from ..pinhole import FOCAL_SHARE, Pinhole
from ..features import Features, features_of
from ..reader import Line, Reader
from .collection import Shot
from ..global_descriptors import GlobalDescriptors
from .distortions import DISTORTIONS
from .gradients import Gradients, gradients_of

# More and finer features than tracking needs: words must tell apart floors that look alike.
MAX_WORD_FEATURES = 2000
WORD_SIDE_PX = 960


@dataclass(frozen=True)
class Sight:
    """A photograph's camera, features and lines of text."""

    shot: Shot
    camera: Pinhole
    tracking: Features
    words: Features
    gradients: Gradients
    lines: list[Line]
    global_descriptor: dict[str, Any] | None = None


def look(
    shots: list[Shot],
    left_out: LeftOut,
    *,
    threads: int,
    cache: Path | None = None,
    focal_px: float | None = None,
    signs: bool = True,
    global_model: str | None = None,
    distortion: str | None = None,
    progress: Callable[[], None] = lambda: None,
) -> Iterator[Sight]:
    """Yield what is in each photograph that can be read, in order."""
    reader = Reader(cache) if signs else None
    # The network's session may serve several threads.
    network = GlobalDescriptors(global_model) if global_model else None

    def sight(shot: Shot) -> Sight | None:
        with left_out.part():
            data, image, _ = shot.frame.view()
            # The focal length stays that of the whole photograph.
            focal = focal_px or FOCAL_SHARE * max(image.shape[:2])
            if distortion is not None:
                image = DISTORTIONS[distortion](image)
                data += distortion.encode()
            return Sight(
                shot,
                Pinhole.of(image, focal),
                features_of(image),
                features_of(image, MAX_WORD_FEATURES, WORD_SIDE_PX),
                gradients_of(image),
                reader.read(data, image) if reader is not None else [],
                network.of(image) if network is not None else None,
            )
        return None

    for seen in ahead(shots, sight, threads):
        if seen is not None:
            yield seen
        progress()
