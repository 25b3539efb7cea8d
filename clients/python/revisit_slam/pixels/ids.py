"""Ids of keyframes, made from the names of what they come from: two names, two ids."""

from __future__ import annotations

import hashlib
import re
from collections import Counter
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TypeVar

Thing = TypeVar("Thing", Path, str)
MAX_ID = 128
DIGEST_CHARS = 16


def plain_id(name: str, most: int = MAX_ID) -> str:
    """Return a name with only what the API allows in an id; other names give other ids.

    What is not allowed is spelled by its code between colons, and a colon too. Of a name that is too long the end is a digest.
    """
    spelled = re.sub(r"[^A-Za-z0-9._-]", lambda letter: f":{ord(letter[0]):x}:", name)
    if len(spelled) > most:
        digest = hashlib.sha256(name.encode("utf-8", "surrogateescape")).hexdigest()[:DIGEST_CHARS]
        return f"{spelled[: most - DIGEST_CHARS - 1]}:{digest}"
    return f":{spelled}:" if spelled in ("", ".", "..") else spelled


def ids_of(paths: Iterable[Path], folder: Path) -> dict[Path, str]:
    """Return an id for each path below `folder`: its stem, or as much more of it as tells it from the others."""
    inside = {path: path.relative_to(folder) if path.is_relative_to(folder) else path for path in paths}
    return _told_apart(inside, lambda path: inside[path].stem, lambda path: dotted(inside[path]), lambda path: inside[path].as_posix())


def ids_of_names(names: Iterable[str]) -> dict[str, str]:
    """Return an id for each name of a picture within a model: its folders and its stem, or all of it where another has the same."""
    return _told_apart(names, lambda name: dotted(Path(name)), str)


def dotted(path: Path) -> str:
    """Return a path without its ending, with dots between its parts; what leads out of a folder is left out."""
    return ".".join(part for part in (*path.parts[:-1], path.stem) if part not in ("/", "..", "."))


def _told_apart(things: Iterable[Thing], *forms: Callable[[Thing], str]) -> dict[Thing, str]:
    """Return an id for each thing by the first form that no other thing has; the last form tells all of them apart."""
    ids: dict[Thing, str] = {}
    left = sorted(set(things))
    for form in forms:
        made = {thing: plain_id(form(thing)) for thing in left}
        counts, taken = Counter(made.values()), set(ids.values())
        ids |= {thing: id for thing, id in made.items() if counts[id] == 1 and id not in taken}
        left = [thing for thing in left if thing not in ids]
    return ids
