"""Doctor: what a folder or a file is, and what would be read of it, assumed and left out."""

from __future__ import annotations

import shlex
import tempfile
from collections.abc import Callable
from pathlib import Path

from .arguments import parser
from .errors import RevisitError
from .files import first_bytes, what_is
from .imports.opened import Wanted
from .imports.opening import open_file
from .left_out import Unreadable
from .pixels.frames import SUFFIXES, readable
from .pixels.sources.opening import open_source
from .plans.reading import READERS, read_plan

# What tells a folder, and what may then read it; any other is a folder of photographs.
FOLDERS = (
    (("rgb.txt",), ("tum",)),
    (("mav0/cam0", "cam0"), ("euroc",)),
    (("cameras.bin", "cameras.txt"), ("colmap", "import")),
    (("metadata.yaml", "*.mcap", "*.db3", "*.bag"), ("bag", "import")),
)
RECORDINGS = ("a ROS 2 recording (MCAP)", "a ROS 1 bag", "an SQLite database")


def doctor(path: Path) -> int:
    """Print what would be read, and the command that reads it."""
    refused = []
    for command in _commands(path):
        words = [command, str(path), *(("-o", "recording.ndjson") if command in ("import", "plan") else ())]
        look: Callable[[list[str]], list[str]] = {"plan": _plan, "import": _import}.get(command, _source)
        try:
            told = look(words)
        except RevisitError as error:
            refused.append(f"not read by `{command}`: {error}")
            continue
        print("\n".join((str(path), *told, *refused, f"now: revisit-play {shlex.join(words)}")))
        return 0
    raise RevisitError("; ".join(refused))


def _commands(path: Path) -> tuple[str, ...]:
    """Return the commands that may read it, the likeliest first."""
    if path.is_dir():
        return next((then for names, then in FOLDERS if any(any(path.glob(name)) for name in names)), ("images",))
    suffix, form = path.suffix.lower(), what_is(first_bytes(path))
    if suffix in SUFFIXES:
        raise RevisitError(f"{path}: one picture; its folder is played: revisit-play doctor {path.parent}")
    if suffix in READERS:
        return ("plan",)
    if form in RECORDINGS:
        return ("import",) if suffix == ".db" else ("bag", "import")
    return ("import",) if suffix == ".msg" else ("video",)


def _source(words: list[str]) -> list[str]:
    with tempfile.TemporaryDirectory(prefix="revisit-play-") as work:
        source = open_source(parser().parse_args(words), Path(work))
        count = 0
        for _, frame, _, camera in readable(source.frames, None, source.left_out):
            count += 1
            try:
                frame.depths_m(camera)
            except Unreadable as error:
                source.left_out.add(error.name, error.why)
    if not count:
        raise source.nothing()
    return source.told()


def _plan(words: list[str]) -> list[str]:
    plan = read_plan(Path(words[1]))
    read = [f"reads {len(signs)} signs of level {level}" for level, signs in plan.levels().items()]
    return [*read, *(f"assumed: {one}" for one in plan.assumed), *plan.notes, *plan.left_out.told()]


def _import(words: list[str]) -> list[str]:
    opened = open_file(Path(words[1]), "auto", Wanted())
    count = sum(1 for _ in opened.keyframes())
    if not count:
        raise RevisitError("; ".join((f"{words[1]}: no keyframe in it", *opened.notes)))
    return [f"reads {count} keyframes of {opened.system}", *opened.notes]
