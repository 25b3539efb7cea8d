"""Prior anchors of a plan: a name and a body for each sign."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from .plan import Plan, Sign

ID_CHARS = 128
# The height of a sign above its floor, in metres.
HEIGHT_M = 1.5
DECIMALS = 4


def priors(plan: Plan, class_: str) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield the id and the body of each sign's prior anchor; a sign keeps its id when the plan is read again."""
    used: dict[str, int] = {}
    for sign in plan.signs:
        name = _id(f"{sign.level}.{sign.text}")
        used[name] = used.get(name, 0) + 1
        number = "" if used[name] == 1 else f".{used[name]}"
        yield f"{name[: ID_CHARS - len(number)]}{number}", _body(plan, sign, class_)


def frame(level: str) -> str:
    """Return the frame of a floor."""
    return f"plan:{_id(level)}"


def _body(plan: Plan, sign: Sign, class_: str) -> dict[str, Any]:
    position = [round(sign.at[0], DECIMALS), round(sign.at[1], DECIMALS), HEIGHT_M]
    body: dict[str, Any] = {"class": class_, "description": sign.text, "position": position, "frame": frame(sign.level)}
    if sign.normal is not None:
        body["normal"] = [round(sign.normal[0], DECIMALS), round(sign.normal[1], DECIMALS), 0.0]
    body["source"] = plan.source[:256]
    return body


def _id(text: str) -> str:
    """Return a text as an id: letters of any language are spelled by their code, so that two texts stay two ids."""
    def spelled(match: re.Match[str]) -> str:
        return "_" if match[0].isspace() else f"_{ord(match[0]):x}"

    made = re.sub(r"[^A-Za-z0-9._:-]", spelled, text)[: ID_CHARS - 8]
    return f"sign-{made}" if re.fullmatch(r"a-[0-9]+|\.{1,2}|", made) else made
