"""`revisit-play import`: a map of another system becomes a recording."""

from __future__ import annotations

import argparse
import sys
from typing import Any

import msgspec
import numpy as np

from ..errors import RevisitError, one_line
from ..pixels.recording import Recording
from .opened import Opened, Wanted
from .opening import open_file

COUNTED = ("keyframes", "map_points", "observations", "features", "words", "detections", "loops", "left_out")


def play_import(chosen: argparse.Namespace, settings: dict[str, Any]) -> int:
    """Read a file, and write its recording."""
    if not chosen.source.exists():
        raise RevisitError(f"{chosen.source}: no such file")
    wanted = Wanted(chosen.session, chosen.metres_per_unit, chosen.topic, chosen.database)
    opened = open_file(chosen.source, chosen.form, wanted)
    name = chosen.source.resolve().name.encode("utf-8", "replace").decode()
    body = {"description": f"{opened.system} {name}", "metric": opened.metric, "settings": settings}
    with Recording(chosen.output) as recording:
        recording.write("map", id=chosen.map, body=body)
        counts = _write(opened, recording, chosen.query)
        if not counts["keyframes"]:
            raise RevisitError("; ".join((f"{chosen.source}: no keyframe in it", *opened.account.told())))
    for line in opened.account.told():
        print(f"revisit-play: {one_line(line)}", file=sys.stderr)
    if chosen.json:
        print(msgspec.json.encode(counts).decode())
    else:
        told = (f"{count:,} {what.replace('_', ' ')}" for what, count in counts.items() if count)
        print(f"{opened.system}: {', '.join(told)}")
        print(f"recording: {chosen.output}; now: revisit replay {chosen.output}")
    return 0


def _write(opened: Opened, recording: Recording, query: bool) -> dict[str, int]:
    counts = dict.fromkeys(COUNTED, 0)
    for seen in opened.keyframes():
        recording.write("keyframe", id=seen.id, body=seen.body())
        if query:
            recording.query(seen.id, None)
        for number, earlier in enumerate(seen.loops, counts["loops"]):
            recording.write("loop", body={"id": f"loop-{number}", "keyframe": seen.id, "candidate": earlier})
        points = seen.features.points if seen.features is not None else np.empty(0)
        # A feature of a point is an observation as well.
        observations = len(seen.observes) + int((points >= 0).sum())
        found = (1, len(seen.placed), observations, len(points), len(seen.words or ()), len(seen.detections), len(seen.loops))
        counts |= {what: counts[what] + count for what, count in zip(COUNTED, found)}
    counts["left_out"] = opened.account.left_out.count
    return counts
