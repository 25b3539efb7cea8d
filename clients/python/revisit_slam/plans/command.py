"""`revisit-play plan`: plans become prior anchors of a map."""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from typing import Any

from ..client import Client
from ..errors import RevisitError
from ..left_out import shown
from ..pixels.recording import Recording
from ..problems import found
from .plan import Plan
from .priors import frame, priors
from .reading import read_plan

SHOWN_MAX = 20


def play_plans(chosen: argparse.Namespace) -> int:
    """Read plans, tell what they show, and put or write their prior anchors."""
    plans, errors = [], []
    for path in chosen.source:
        try:
            plans.append(read_plan(path, chosen.level, chosen.language))
        except RevisitError as error:
            errors.append(error)
    if not plans:
        raise RevisitError("; ".join(map(str, errors)))
    lines = _lines(plans, chosen.sign_class)
    for plan in plans:
        _tell(plan)
    for error in errors:
        print(f"revisit-play: left out: {error}", file=sys.stderr)
    if not lines:
        raise RevisitError("the plans show no signs")
    _warn_of_repeated(plans)
    if chosen.output:
        with Recording(chosen.output) as recording:
            recording.write("map", id=chosen.map, body={"metric": True})
            for name, body in lines:
                recording.write("anchor", id=name, body=body)
        print(f"recording: {chosen.output}", file=sys.stderr)
    if chosen.server:
        with Client(chosen.server, key=chosen.key) as client:
            if found(client.get_map, chosen.map) is None:
                client.put_map(chosen.map, {"metric": True})
            for name, body in lines:
                client.put_prior_anchor(chosen.map, name, body)
        print(f"{len(lines)} prior anchors in {chosen.map}")
    return 0


def _lines(plans: list[Plan], class_: str) -> list[tuple[str, dict[str, Any]]]:
    """Return the prior anchors of all plans; of one floor in two files neither may hide the other."""
    lines: dict[str, dict[str, Any]] = {}
    for plan in plans:
        for name, body in priors(plan, class_):
            if lines.setdefault(name, body) != body:
                raise RevisitError(
                    f"{plan.source}: {name} is in another file as well, elsewhere: name the floors with --level, one file at a time"
                )
    return list(lines.items())


def _tell(plan: Plan) -> None:
    for level, signs in plan.levels().items():
        print(f"{plan.source}: level {level}: {len(signs)} signs in frame {frame(level)}")
    for note in (*(f"assumed: {one}" for one in plan.assumed), *plan.notes[:SHOWN_MAX], *plan.left_out.told()):
        print(f"revisit-play: {plan.source}: {note}", file=sys.stderr)


def _warn_of_repeated(plans: list[Plan]) -> None:
    counts = Counter(sign.text for plan in plans for sign in plan.signs)
    repeated = [f"{text} ({count})" for text, count in sorted(counts.items(), key=lambda item: (-item[1], item[0])) if count > 1]
    if repeated:
        print(f"revisit-play: repeated names align nothing alone: {shown(repeated, SHOWN_MAX)}", file=sys.stderr)
