"""Arguments of `revisit-play import`."""

from __future__ import annotations

import argparse
import re
from pathlib import Path
from typing import Any

from ..errors import RevisitError

# A keyframe's number comes after it, within the 128 characters of an id.
MAX_SESSION = 100
FORMS = ("auto", "colmap", "rtabmap", "stella", "mcap")


def add_import(commands: Any) -> None:
    """Add the command to the parser."""
    command: argparse.ArgumentParser = commands.add_parser(
        "import", help="turn another system's map into a recording",
        description="Read the map of COLMAP (a model's folder, or a database), RTAB-Map (.db), stella_vslam (.db or .msg), or a "
        "ROS 2 recording with rtabmap_msgs/MapData (.mcap, or a bag's folder), and write a recording that `revisit replay` plays. "
        "No server, no ROS and none of these systems is needed. The file is read piece by piece, and never written to.",
    )  # fmt: skip
    add = command.add_argument
    add("source", type=Path, metavar="FILE")
    add("-o", "--output", type=Path, metavar="NDJSON", required=True, help="the recording (.ndjson or .ndjson.zst)")
    add("--format", dest="form", choices=FORMS, default="auto", help="what the file is [told by its first bytes and its tables]")
    add("--map", metavar="ID", default="imported", help="the map's id [imported]")
    add("--session", metavar="NAME", help="name of the sessions, and of keyframes that only have numbers [the file's name]")
    add("--metres-per-unit", type=float, metavar="M", help="length of the unit, where the system knows none (COLMAP, one camera)")
    add("--database", type=Path, metavar="DB", help="with a COLMAP model: its database, whose verified matches are covisible")
    add("--topic", metavar="TOPIC", help="the topic of MapData [the only one]")
    add("--query", action="store_true", help="ask for each keyframe whether it is a loop, before the system's own loops of it")
    add("--json", action="store_true", help="print the counts as one JSON object")
    add("--set", action="append", default=[], metavar="NAME=VALUE", help="a setting of the map; VALUE is JSON or a word")


def check_import(chosen: argparse.Namespace) -> None:
    """Refuse what cannot be meant of an import."""
    if chosen.session is not None and not re.fullmatch(rf"[A-Za-z0-9._:-]{{1,{MAX_SESSION}}}", chosen.session):
        letters = "letters, digits, dots, underscores, colons or hyphens"
        raise RevisitError(f"--session {chosen.session}: 1 to {MAX_SESSION} {letters}")
    if chosen.output.absolute() == chosen.source.absolute():
        raise RevisitError(f"--output {chosen.output}: that is the file itself")
    if not chosen.source.exists():
        raise RevisitError(f"{chosen.source}: no such file")
