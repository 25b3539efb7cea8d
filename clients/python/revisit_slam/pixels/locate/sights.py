"""Sights: what is taken from each photograph, in threads, before anything is sent."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from ...left_out import LeftOut
from ..ahead import ahead
from ..features import Features, features_of
from ..global_descriptors import GlobalDescriptors
from ..options import Options
from ..pinhole import FOCAL_SHARE, Pinhole
from ..reader import Line, Reader
from .collection import Shot
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
    shots: list[Shot], options: Options, left_out: LeftOut, signs: bool, distortion: str | None, progress: Callable[[int], None]
) -> list[Sight]:
    """Return what is in each photograph that can be read, in order."""
    reader = Reader(options.cache) if signs else None
    # The network's session may serve several threads.
    network = GlobalDescriptors(options.global_model) if options.global_model else None

    def sight(shot: Shot) -> Sight | None:
        with left_out.part():
            data, image, _ = shot.frame.view()
            # The focal length stays that of the whole photograph.
            focal = options.focal_px or FOCAL_SHARE * max(image.shape[:2])
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

    return [seen for seen in ahead(shots, sight, options.threads, progress) if seen is not None]
