"""`revisit-play import`: a map of another system becomes a recording."""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass
from typing import Any

import msgspec

from ..errors import RevisitError
from ..pixels.recording import Recording
from .damage import in_one_line, one_line
from .opened import Opened, Wanted
from .opening import open_file


@dataclass
class Counts:
    """What was written."""

    keyframes: int = 0
    map_points: int = 0
    observations: int = 0
    features: int = 0
    words: int = 0
    detections: int = 0
    loops: int = 0
    left_out: int = 0

    def told(self) -> str:
        """Return it for a person."""
        return ", ".join(f"{count:,} {name.replace('_', ' ')}" for name, count in vars(self).items() if count or name == "keyframes")


def play_import(chosen: argparse.Namespace, settings: dict[str, Any]) -> int:
    """Read a file, and write its recording."""
    with in_one_line():
        return _import(chosen, settings)


def _import(chosen: argparse.Namespace, settings: dict[str, Any]) -> int:
    wanted = Wanted(chosen.session, chosen.metres_per_unit, chosen.topic, chosen.database)
    opened = open_file(chosen.source, chosen.form, wanted)
    name = chosen.source.resolve().name.encode("utf-8", "replace").decode()
    body = {"description": f"{opened.system} {name}", "metric": opened.metric, "settings": settings}
    with Recording(chosen.output) as recording:
        recording.map(chosen.map, body)
        counts = _write(opened, recording, chosen.query)
        if not counts.keyframes:
            raise RevisitError("; ".join((f"{chosen.source}: no keyframe in it", *opened.notes)))
    for line in opened.notes:
        print(f"revisit-play: {one_line(line)}", file=sys.stderr)
    if chosen.json:
        print(msgspec.json.encode(vars(counts)).decode())
    else:
        print(f"{opened.system}: {counts.told()}")
        print(f"recording: {chosen.output}; now: revisit replay {chosen.output}")
    return 0


def _write(opened: Opened, recording: Recording, query: bool) -> Counts:
    counts = Counts()
    for seen in opened.keyframes():
        recording.keyframe(seen.id, seen.body())
        if query:
            recording.query(seen.id, None)
        for earlier in seen.loops:
            recording.loop({"id": f"loop-{counts.loops}", "keyframe": seen.id, "candidate": earlier})
            counts.loops += 1
        counts.keyframes += 1
        counts.map_points += len(seen.placed)
        # Of a feature's point it is an observation as well.
        counts.observations += len(seen.observes) + (int((seen.features.points >= 0).sum()) if seen.features is not None else 0)
        counts.features += len(seen.features.points) if seen.features is not None else 0
        counts.words += len(seen.words or ())
        counts.detections += len(seen.detections)
    counts.left_out = opened.account.left_out.count
    return counts
