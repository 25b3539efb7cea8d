"""Gallery: sends the known photographs, a map for each floor and a session for each video."""

from __future__ import annotations

import itertools
from collections import defaultdict, deque
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from ...client import Client
from ...errors import RevisitError
from ..reader import Line
from ..signs import Neighbour, Sign, judge
from ..tracking import LOOK_BACK, Tracker
from .bodies import Bodies
from .sights import Sight


def send_gallery(client: Client, sights: list[Sight], bodies: Bodies, threads: int) -> None:
    """Make the maps, and store every photograph of the gallery; videos are matched with themselves in threads."""
    of_map: dict[str, dict[str, list[Sight]]] = defaultdict(lambda: defaultdict(list))
    for sight in sights:
        of_map[sight.shot.map][sight.shot.session].append(sight)
    with ThreadPoolExecutor(threads) as pool:
        # Map by map, so that the bodies of one are in memory at a time.
        for map, videos in sorted(of_map.items()):
            client.put_map(map, {"description": "Photographs, by revisit-play locate", "metric": False})
            keyframes = itertools.chain.from_iterable(pool.map(lambda video: _keyframes(video, bodies), videos.values()))
            for line in client.put_keyframes(map, keyframes):
                if line.problem is not None:
                    raise RevisitError(f"{line.id}: the server refused it: {line.problem.detail}")


def _keyframes(video: list[Sight], bodies: Bodies) -> list[dict[str, Any]]:
    """Return the keyframes of a video; photographs that overlap are covisible, and their readings bear each other out."""
    tracker = Tracker()
    recent: deque[tuple[str, list[Line], list[Sign]]] = deque(maxlen=LOOK_BACK)
    keyframes = []
    for number, sight in enumerate(video):
        shot = sight.shot
        tracked = tracker.look(shot.frame, sight.tracking, sight.camera)
        tracker.keep(tracked)
        before = {id: (lines, signs) for id, lines, signs in recent}
        neighbours = [Neighbour(*before[id], found) for id, found in tracked.overlaps if id in before]
        signs = judge(sight.lines, sight.camera, neighbours)
        recent.append((shot.frame.id, sight.lines, signs))
        keyframes.append({"id": shot.frame.id, **bodies.gallery(number, sight, tracked, signs)})
    return keyframes
