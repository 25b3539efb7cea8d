"""`revisit-play plan`: plans become prior anchors of a map."""

from __future__ import annotations

import argparse
import contextlib
import json
import sys
from pathlib import Path
from typing import Any

from ..client import Client
from ..errors import RevisitError
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
        raise RevisitError("\nrevisit-play: ".join(map(str, errors)))
    lines = _lines(plans, chosen.sign_class)
    for plan in plans:
        _tell(plan)
    for error in errors:
        print(f"revisit-play: left out: {error}", file=sys.stderr)
    if not lines:
        raise RevisitError("the plans show no signs")
    _warn_of_repeated(plans)
    with contextlib.ExitStack() as stack:
        if chosen.output:
            _write(chosen.output, chosen.map, lines)
            print(f"recording: {chosen.output}", file=sys.stderr)
        if chosen.server:
            client = stack.enter_context(Client(chosen.server, key=chosen.key))
            if _is_missing(client, chosen.map):
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
    repeated = Plan("", [sign for plan in plans for sign in plan.signs]).repeated()
    if not repeated:
        return
    shown = [f"{text} ({count})" for text, count in sorted(repeated.items(), key=lambda item: (-item[1], item[0]))]
    more = f" and {len(shown) - SHOWN_MAX} more" if len(shown) > SHOWN_MAX else ""
    print(
        f"revisit-play: repeated names align nothing alone: {', '.join(shown[:SHOWN_MAX])}{more}",
        file=sys.stderr,
    )


def _is_missing(client: Client, map: str) -> bool:
    from ..problems import ProblemError

    try:
        client.get_map(map)
    except ProblemError as problem:
        if problem.status == 404:
            return True
        raise
    return False


def _write(path: Path, map: str, lines: list[tuple[str, dict[str, Any]]]) -> None:
    written = [{"op": "map", "id": map, "body": {"metric": True}}]
    written += [{"op": "anchor", "id": name, "body": body} for name, body in lines]
    try:
        path.write_text("".join(json.dumps(line, ensure_ascii=False) + "\n" for line in written), encoding="utf-8")
    except OSError as error:
        raise RevisitError(f"{path}: cannot be written: {error.strerror}") from error
