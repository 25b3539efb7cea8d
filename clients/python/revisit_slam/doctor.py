"""Doctor: what a folder or a file is, and what would be read of it, assumed and left out."""

from __future__ import annotations

import shlex
import tempfile
from pathlib import Path

from .arguments import parser
from .errors import RevisitError
from .imports.opened import Wanted
from .imports.opening import open_file
from .pixels.frames import readable
from .pixels.sources.opening import open_source
from .plans.reading import READERS, read_plan

# What tells a folder, and the commands that may read it; any other is a folder of photographs.
FOLDERS = {
    ("rgb.txt",): ("tum",),
    ("mav0/cam0", "cam0"): ("euroc",),
    ("cameras.bin", "cameras.txt"): ("colmap", "import"),
    ("metadata.yaml", "*.mcap", "*.db3", "*.bag"): ("bag", "import"),
}
# The same for the endings of files; any other is a film.
FILES = {
    **dict.fromkeys(READERS, ("plan",)),
    **dict.fromkeys((".mcap", ".db3", ".bag", ".active"), ("bag", "import")),
    **dict.fromkeys((".db", ".msg"), ("import",)),
}


def doctor(path: Path) -> int:
    """Print what would be read, and the command that reads it."""
    commands = FILES.get(path.suffix.lower(), ("video",))
    if path.is_dir():
        found = (commands for names, commands in FOLDERS.items() if any(any(path.glob(name)) for name in names))
        commands = next(found, ("images",))
    refused: list[str] = []
    for command in commands:
        words = [command, str(path), *(("-o", "recording.ndjson") if command in ("import", "plan") else ())]
        try:
            told = {"plan": _plan, "import": _import}.get(command, _source)(words)
        except RevisitError as error:
            refused.append(f"not read by `{command}`: {error}")
            continue
        print("\n".join((str(path), *told, *refused, f"now: revisit-play {shlex.join(words)}")))
        return 0
    raise RevisitError("; ".join(refused))


def _source(words: list[str]) -> list[str]:
    with tempfile.TemporaryDirectory(prefix="revisit-play-") as work:
        source = open_source(parser().parse_args(words), Path(work))
        for _, frame, _, camera in readable(source.frames, None, source.left_out):
            with source.left_out.part():
                frame.depths_m(camera)
    return source.checked().told()


def _plan(words: list[str]) -> list[str]:
    plan = read_plan(Path(words[1]))
    read = [f"reads {len(signs)} signs of level {level}" for level, signs in plan.levels().items()]
    return [*read, *(f"assumed: {one}" for one in plan.assumed), *plan.notes, *plan.left_out.told()]


def _import(words: list[str]) -> list[str]:
    opened = open_file(Path(words[1]), "auto", Wanted())
    count = sum(1 for _ in opened.keyframes())
    if not count:
        raise RevisitError("; ".join((f"{words[1]}: no keyframe in it", *opened.account.told())))
    return [f"reads {count} keyframes of {opened.system}", *opened.account.told()]
