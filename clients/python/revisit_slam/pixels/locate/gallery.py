"""Gallery: sends the known photographs, a map for each floor and a session for each video."""

from __future__ import annotations

from collections import defaultdict, deque
from collections.abc import Iterator
from typing import Any

from ...client import Client
from ...errors import RevisitError
from ..reader import Line
from ..signs import Neighbour, Sign, judge
from ..tracking import LOOK_BACK, Tracker
from .bodies import Bodies
from .sights import Sight


def send_gallery(client: Client, sights: list[Sight], bodies: Bodies) -> None:
    """Make the maps, and store every photograph of the gallery."""
    of_map: dict[str, list[tuple[str, dict[str, Any]]]] = defaultdict(list)
    for sight, body in _keyframes(sights, bodies):
        of_map[sight.shot.map].append((sight.shot.name, body))
    for map, keyframes in sorted(of_map.items()):
        client.put_map(map, {"description": "Photographs, by revisit-play locate", "metric": False})
        for line in client.put_keyframes(map, ({"id": id, **body} for id, body in keyframes)):
            if line.problem is not None:
                raise RevisitError(f"{line.id}: the server refused it: {line.problem.detail}")


def _keyframes(sights: list[Sight], bodies: Bodies) -> Iterator[tuple[Sight, dict[str, Any]]]:
    """Yield the bodies; photographs of a video that overlap are covisible, and their readings bear each other out."""
    tracker = Tracker()
    recent: deque[tuple[str, list[Line], list[Sign]]] = deque(maxlen=LOOK_BACK)
    numbers: dict[str, int] = defaultdict(int)
    for sight in sights:
        shot = sight.shot
        tracked = tracker.look(shot.frame, sight.tracking, sight.camera)
        tracker.keep(tracked)
        before = {id: (lines, signs) for id, lines, signs in recent}
        neighbours = [Neighbour(*before[id], found) for id, found in tracked.overlaps if id in before]
        signs = judge(sight.lines, sight.camera, neighbours)
        recent.append((shot.name, sight.lines, signs))
        yield sight, bodies.gallery(numbers[shot.session], sight, tracked, signs)
        numbers[shot.session] += 1
