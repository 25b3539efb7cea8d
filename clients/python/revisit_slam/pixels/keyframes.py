"""Keyframes: from a folder of photographs to bodies that the API takes, in order."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..left_out import LeftOut
from .ahead import ahead
from .bodies import Bodies
from .features import features_of
from .frames import Frame, View, readable
from .options import Options
from .reader import Line, Reader
from .signs import Neighbour, Sign, judge
from .tracking import LOOK_BACK, Tracked, Tracker
from .turn import moved

# A photograph that shows at least this share of the last keyframe's view tells nothing new.
MAX_OVERLAP_SHARE = 0.8
MAX_OVERLAP_INLIERS = 60
MAX_DETECTIONS = 64


@dataclass(frozen=True)
class Keyframe:
    """A photograph's keyframe: the body to send, and the signs in it."""

    frame: Frame
    body: dict[str, Any]
    signs: list[Sign]


@dataclass(frozen=True)
class _Chosen:
    index: int
    tracked: Tracked
    view: View


def keyframes(frames: Iterable[Frame], options: Options, left_out: LeftOut) -> Iterator[Keyframe]:
    """Yield the keyframes of photographs in order; reading runs ahead in `options.threads` threads.

    Lines and signs are judged as a person sees them; what leaves has the pixels of the camera.
    """
    bodies = Bodies(options, left_out)
    recent: deque[tuple[str, list[Line], list[Sign], np.ndarray]] = deque(maxlen=LOOK_BACK)
    reader = Reader(options.cache)

    def read(one: _Chosen) -> tuple[_Chosen, list[Line]]:
        return one, reader.read(one.view.key, one.view.turn.seen(one.view.image))

    for chosen, lines in ahead(_choose(frames, options, left_out), read, options.threads, lambda _: None):
        tracked, turn = chosen.tracked, chosen.view.turn
        width, height = (tracked.camera.width, tracked.camera.height)[:: -1 if turn.transposed else 1]
        matrix = turn.stored_from_seen(width, height)
        earlier = {id: (before, made, other) for id, before, made, other in recent}
        neighbours = []
        for before, made, other, found in ((*earlier[id], found) for id, found in tracked.overlaps if id in earlier):
            neighbours.append(Neighbour(before, made, found.between(np.linalg.inv(other), matrix)))
        signs = judge(lines, replace(tracked.camera, width=width, height=height), neighbours)[:MAX_DETECTIONS]
        recent.append((tracked.frame.id, lines, signs, matrix))
        signs = [replace(sign, box=moved(sign.box, matrix)) for sign in signs]
        yield Keyframe(tracked.frame, bodies.of(chosen.index, tracked, chosen.view, signs), signs)


def _choose(frames: Iterable[Frame], options: Options, left_out: LeftOut) -> Iterator[_Chosen]:
    tracker = Tracker()
    for index, frame, view, camera in readable(frames, options.focal_px, left_out):
        tracked = tracker.look(frame, features_of(view.image), camera)
        if not options.every_frame and any(
            found.share >= MAX_OVERLAP_SHARE and found.inliers >= MAX_OVERLAP_INLIERS for _, found in tracked.overlaps
        ):
            continue
        tracker.keep(tracked)
        yield _Chosen(index, tracked, view)
