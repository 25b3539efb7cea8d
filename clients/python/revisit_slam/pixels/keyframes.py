"""Keyframes: from a folder of photographs to bodies that the API takes, in order."""

from __future__ import annotations

import itertools
import queue
from collections import deque
from collections.abc import Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import numpy as np

from .bodies import Bodies
from .camera import Camera
from .features import features_of
from .frames import Frame
from .options import Options
from .reader import Line, Reader
from .signs import Neighbour, Sign, judge
from .tracking import LOOK_BACK, Tracked, Tracker

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
    data: bytes
    image: np.ndarray


def keyframes(frames: Iterable[Frame], options: Options) -> Iterator[Keyframe]:
    """Yield the keyframes of photographs in order; reading runs ahead in `options.threads` threads."""
    bodies = Bodies(options)
    recent: deque[tuple[str, list[Line], list[Sign]]] = deque(maxlen=LOOK_BACK)
    for chosen, lines in _read(_choose(frames, options), options):
        tracked = chosen.tracked
        earlier = {id: (before, made) for id, before, made in recent}
        neighbours = [Neighbour(*earlier[id], found) for id, found in tracked.overlaps if id in earlier]
        signs = judge(lines, tracked.camera, neighbours)[:MAX_DETECTIONS]
        recent.append((tracked.frame.id, lines, signs))
        yield Keyframe(tracked.frame, bodies.of(chosen.index, tracked, chosen.image, signs), signs)


def _choose(frames: Iterable[Frame], options: Options) -> Iterator[_Chosen]:
    tracker = Tracker()
    for index, frame in enumerate(frames):
        data, image = frame.picture()
        known = frame.calibration
        camera = Camera.of(image, options.focal_px) if known is None else known.camera(image, frame.shown)
        tracked = tracker.look(frame, features_of(image), camera)
        if not options.every_frame and any(
            found.share >= MAX_OVERLAP_SHARE and found.inliers >= MAX_OVERLAP_INLIERS for _, found in tracked.overlaps
        ):
            continue
        tracker.keep(tracked)
        yield _Chosen(index, tracked, data, image)


def _read(chosen: Iterator[_Chosen], options: Options) -> Iterator[tuple[_Chosen, list[Line]]]:
    """Read ahead in threads. Each engine has one thread of its own, so that readings do not depend on their number."""
    readers: queue.SimpleQueue[Reader] = queue.SimpleQueue()
    for _ in range(options.threads):
        readers.put(Reader(options.cache))

    def read(one: _Chosen) -> list[Line]:
        reader = readers.get()
        try:
            return reader.read(one.data, one.image)
        finally:
            readers.put(reader)

    with ThreadPoolExecutor(options.threads) as pool:
        ahead: deque[tuple[_Chosen, Future[list[Line]]]] = deque()
        try:
            for one in itertools.chain(chosen, [None]):
                if one is not None:
                    ahead.append((one, pool.submit(read, one)))
                while ahead and (one is None or len(ahead) > 2 * options.threads):
                    first, future = ahead.popleft()
                    yield first, future.result()
        finally:
            for _, future in ahead:
                future.cancel()
