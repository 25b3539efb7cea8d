"""Keyframes: from a folder of photographs to bodies that the API takes, in order."""

from __future__ import annotations

import base64
import itertools
import queue
from collections import deque
from collections.abc import Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from ..errors import RevisitError
from .camera import Camera
from .features import Features, features_of
from .frames import Frame
from .reader import Line, Reader
from .signs import LETTER_HEIGHT_M, Neighbour, Sign, detection, judge
from .tracking import LOOK_BACK, Tracked, Tracker, quaternion
from .vocabulary import Vocabulary

# A photograph that shows at least this share of the last keyframe's view tells nothing new.
MAX_OVERLAP_SHARE = 0.8
MAX_OVERLAP_INLIERS = 60
MAX_SENT_FEATURES = 500
MAX_DETECTIONS = 64


@dataclass(frozen=True)
class Options:
    """What decides how photographs become keyframes."""

    every_frame: bool = False
    features: bool = False
    crops: bool = True
    focal_px: float | None = None
    letter_height_m: float = LETTER_HEIGHT_M
    cache: Path | None = None
    threads: int = 1


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
    vocabulary = Vocabulary.shipped()
    recent: deque[tuple[str, list[Line], list[Sign]]] = deque(maxlen=LOOK_BACK)
    for chosen, lines in _read(_choose(frames, options), options):
        tracked = chosen.tracked
        earlier = {id: (before, made) for id, before, made in recent}
        neighbours = [Neighbour(*earlier[id], found) for id, found in tracked.overlaps if id in earlier]
        signs = judge(lines, tracked.camera, neighbours)[:MAX_DETECTIONS]
        recent.append((tracked.frame.id, lines, signs))
        yield Keyframe(tracked.frame, _body(chosen, signs, vocabulary, options), signs)


def _choose(frames: Iterable[Frame], options: Options) -> Iterator[_Chosen]:
    tracker = Tracker()
    for index, frame in enumerate(frames):
        data = frame.path.read_bytes()
        image = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR) if data else None
        if image is None:
            raise RevisitError(f"{frame.path}: not a picture that OpenCV reads")
        tracked = tracker.look(frame, features_of(image), Camera.of(image, options.focal_px))
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


def _body(chosen: _Chosen, signs: list[Sign], vocabulary: Vocabulary, options: Options) -> dict[str, Any]:
    tracked = chosen.tracked
    body: dict[str, Any] = {
        "session": tracked.session,
        # Photographs carry no time that can be trusted: one a second, in order.
        "stamp": {"sec": chosen.index + 1, "nanosec": 0},
        "pose": {
            "translation": {"x": 0.0, "y": 0.0, "z": 0.0},
            "rotation": quaternion(tracked.session_from_camera),
        },
        "camera": tracked.camera.body(),
        "bow": vocabulary.bag(tracked.features.descriptors),
        "covisible": [{"keyframe": id, "shared": shared} for id, shared in tracked.covisible],
    }
    if signs:
        body["detections"] = [
            detection(
                sign, chosen.image, tracked.camera, tracked.session_from_camera, options.letter_height_m, options.crops
            )
            for sign in signs
        ]
    if options.features and len(tracked.features):
        body["features"] = _features(tracked.features)
    return body


def _features(features: Features) -> dict[str, Any]:
    kept = features.keypoints[:MAX_SENT_FEATURES]
    return {
        "descriptor_bytes": 32,
        "descriptors": base64.b64encode(features.descriptors[:MAX_SENT_FEATURES].tobytes()).decode(),
        "keypoints": [[round(float(u), 2), round(float(v), 2), int(o), round(float(a), 1)] for u, v, o, a in kept],
    }
