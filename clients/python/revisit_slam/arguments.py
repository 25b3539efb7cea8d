"""Arguments of revisit-play."""

from __future__ import annotations

import argparse
import os
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

from .errors import RevisitError

ID = re.compile(r"[A-Za-z0-9._:-]{1,128}")
EVERY_S = 0.5
CALIBRATION_TERMS = (4, 8, 9)
# A keyframe's number comes after it, within the 128 characters of an id.
MAX_SESSION = 100
FORMS = ("auto", "colmap", "rtabmap", "stella", "mcap")
LETTERS = "letters, digits, dots, underscores, colons or hyphens"


def parser() -> argparse.ArgumentParser:
    """Return the parser of the command line."""
    top = argparse.ArgumentParser(prog="revisit-play", description="Find the photographs that show the same place.")
    commands = top.add_subparsers(dest="command", required=True)
    common, focal = _common(), _focal()
    terms = "FX,FY,CX,CY[,K1,K2,P1,P2[,K3]]"
    camera = _option("--calibration", metavar=terms, help="the camera, as OpenCV writes it; pictures are undistorted")
    lines = "poses of the camera: lines of `seconds x y z qx qy qz qw`"
    trajectory = _option("--trajectory", type=Path, metavar="FILE", help=lines)
    seconds = f"take a picture every so many seconds, 0: all [{EVERY_S}]"
    every = _option("--every-s", type=float, metavar="S", default=EVERY_S, help=seconds)

    def plays(name: str, source: str, *options: argparse.ArgumentParser, **words: str) -> argparse.ArgumentParser:
        command = commands.add_parser(name, parents=[common, *options], **words)
        command.add_argument("source", type=Path, metavar=source)
        return command

    plays(
        "images",
        "FOLDER",
        focal,
        camera,
        trajectory,
        help="play a folder of photographs",
        description="Read the signs in a folder of photographs, send each as a keyframe, and ask for each whether its "
        "place was seen before. A video is the file's name before its number; names are sorted. Poses are rotations "
        "between overlapping photographs, without any distance; with --trajectory files are named by their time. "
        "Without --server a server is started for the run ($REVISIT_BINARY, beside this Python, or `revisit` on PATH).",
    )
    plays(
        "video", "FILE", focal, camera, trajectory, every, help="play a film",
        description="Take pictures from a film, and play them as `images` does.",
    )  # fmt: skip
    plays(
        "euroc", "DIR", trajectory, every, help="play a sequence in EuRoC's format",
        description="Play the left camera (mav0/cam0) of a sequence in the ASL format of EuRoC, undistorted. Poses are the "
        "ground truth's, where it is there. Distances of signs are assumed.",
    )  # fmt: skip
    tum = plays(
        "tum", "DIR", camera, trajectory, every, help="play a sequence in TUM's RGB-D format",
        description="Play rgb.txt; poses are those of groundtruth.txt, and signs are as far as depth.txt's images tell. "
        "Without --calibration the camera is the benchmark's default (525,525,319.5,239.5).",
    )  # fmt: skip
    tum.add_argument("--depth-units-per-metre", type=float, metavar="N", help="unit of the depth images [5000; RealSense: 1000]")
    colmap = plays(
        "colmap", "MODEL", help="play a COLMAP model",
        description="Play the images of a sparse model (.bin or .txt) with its poses, cameras and points. Signs are as far as "
        "the points around them. Without --metres-per-unit the map is not metric.",
    )  # fmt: skip
    colmap.add_argument("--images", type=Path, metavar="DIR", help="the images' folder [a folder `images` near the model]")
    colmap.add_argument("--metres-per-unit", type=float, metavar="M", help="length of the model's unit")
    bag = plays(
        "bag", "FILE", camera, trajectory, every, help="play a ROS recording (MCAP, SQLite, ROS 1)",
        description="Play the pictures of a recording, undistorted by its CameraInfo; poses are its odometry's, with the "
        "camera's place from /tf_static. Needs no ROS. Distances of signs are assumed.",
    )  # fmt: skip
    for name, what in (("image", "pictures"), ("camera-info", "the camera"), ("odometry", "odometry")):
        bag.add_argument(f"--{name}-topic", metavar="TOPIC", help=f"the topic of {what} [the only one]")
    doctor = commands.add_parser("doctor", help="say what a folder or a file is, and what would be read, assumed and left out")
    doctor.add_argument("source", type=Path, metavar="FOLDER|FILE")
    _add_locate(commands)
    _add_plan(commands)
    _add_import(commands)
    sample = commands.add_parser("sample", help="draw a small building to try it on", description="Draw a small building "
        "with corridors that repeat, plates and exit signs: photographs, and truth.csv.")  # fmt: skip
    sample.add_argument("folder", type=Path, metavar="FOLDER")
    return top


def _add_plan(commands: Any) -> None:
    plan = commands.add_parser("plan", help="put the signs of floor plans into a map, before any robot has seen one",
        description="Read Open-RMF building maps (.building.yaml), indoor GeoJSON (.geojson) or OpenStreetMap's indoor rooms "
        "(.osm), and put each sign as a prior anchor. Each floor has a frame of its own, plan:LEVEL.")  # fmt: skip
    add = plan.add_argument
    add("source", type=Path, nargs="+", metavar="FILE")
    add("--map", metavar="ID", default="building", help="the map's id [building]; made if it is missing")
    add("--server", metavar="URL", help="put the prior anchors into this server's map")
    add("--key", metavar="SECRET", default=os.environ.get("REVISIT_KEY"), help="API key of the server [$REVISIT_KEY]")
    add("-o", "--output", type=Path, metavar="NDJSON", help="write a recording with the prior anchors")
    add("--level", metavar="NAME", help="the floor: names it where the file does not, picks it where the file has several")
    add("--language", metavar="LANG", default="", help="which of names in several languages [the file's own, else the first]")
    add("--class", dest="sign_class", metavar="CLASS", default="door_number", help="class of the signs, as detections name it [door_number]")


def _add_import(commands: Any) -> None:
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


def _add_locate(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    locate = commands.add_parser(
        "locate", parents=[_focal()], help="ask on which floor photographs were taken",
        description="Store photographs as a map for each floor, and ask where others were taken, from pixels alone: against "
        "the whole gallery (A), without the photographs of the same video within 2 s (B), and without that video (C). A video "
        "is the file's name before its number; its photographs are a second apart. One folder may be given twice: the column "
        "`split` of --truth (gallery or query) parts it. Without --truth each video is a map, and only the answers are printed.",
    )  # fmt: skip
    add = locate.add_argument
    add("--gallery", type=Path, metavar="FOLDER", required=True, help="photographs whose floor is known")
    add("--queries", type=Path, metavar="FOLDER", required=True, help="photographs that ask")
    add("--truth", type=Path, metavar="CSV", help="columns frame and floor, and split where both folders are one")
    add("--json", action="store_true", help="print the figures as one JSON object, no table")
    add("--orb", action="store_true", help="also count how far ordinary ORB comes on the same photographs")
    add("--signs", action="store_true", help="read signs as well; slower")
    add("--channels", nargs="+", choices=("words", "global"), default=["words"],
        help="what proposes candidates: words, and a global descriptor by ppocr-det (no place recognition network) [words]")
    add("--distort", choices=("dim", "bright", "blur", "crop"), help="change the photographs that ask, synthetically")
    _add_server(add)
    _add_reading(add)


def _add_server(add: Callable[..., Any]) -> None:
    add("--server", metavar="URL", help="post to this server")
    add("--key", metavar="SECRET", default=os.environ.get("REVISIT_KEY"), help="API key of the server [$REVISIT_KEY]")


def _add_reading(add: Callable[..., Any]) -> None:
    add("--cache", type=Path, metavar="DIR", help="keep what the reader read, for the next run")
    add("--threads", type=int, metavar="N", default=os.cpu_count() or 1, help="photographs read at once [all cores]")


def _common() -> argparse.ArgumentParser:
    common = argparse.ArgumentParser(add_help=False)
    add = common.add_argument
    add("--every-frame", action="store_true", help="take every photograph, also those that overlap the last one")
    _add_server(add)
    add("--map", metavar="ID", default="photographs", help="the map's id [photographs]")
    add("-o", "--output", type=Path, metavar="FILE", help="also write a recording (.ndjson or .ndjson.zst)")
    add("--no-query", action="store_true", help="with -o: write the recording only, no server")
    add("--truth", type=Path, metavar="CSV", help="columns frame and floor: count right and wrong loops")
    add("--json", action="store_true", help="print the figures as one JSON object, no table")
    add("--report", type=Path, metavar="FILE", help="write a page with the pictures of each loop (.html)")
    _add_reading(add)
    add("--features", action="store_true", help="also send features, for the server's geometry")
    add(
        "--global", dest="global_model", metavar="MODEL",
        help="also send the vector of each whole photograph by this model (ppocr-det), which proposes more candidates",
    )  # fmt: skip
    add("--names", action="store_true", help="trust names with a number (Gate 7) as well; they often hang in several places")
    add("--no-crops", action="store_true", help="do not send the pictures of the signs")
    add("--letter-height-m", type=float, metavar="M", help="assumed height of letters [0.3]; only bearings are compared")
    add("--set", action="append", default=[], metavar="NAME=VALUE", help="a setting of the map; VALUE is JSON or a word")
    return common


def _option(name: str, **more: Any) -> argparse.ArgumentParser:
    option = argparse.ArgumentParser(add_help=False)
    option.add_argument(name, **more)
    return option


def _focal() -> argparse.ArgumentParser:
    return _option("--focal-px", type=float, metavar="PX", help="focal length in pixels [0.75 of the longer side]")


def check(chosen: argparse.Namespace) -> None:
    """Refuse what cannot be meant, whatever the command, before anything is done."""
    given = vars(chosen).get
    if given("threads", 1) < 1:
        raise RevisitError(f"--threads {chosen.threads}: at least 1")
    for name in ("focal_px", "letter_height_m", "metres_per_unit", "depth_units_per_metre"):
        value = given(name)
        if value is not None and not 0 < value < 1e6:
            raise RevisitError(f"--{name.replace('_', '-')} {value}: a positive number")
    if not ID.fullmatch(given("map", "photographs")):
        raise RevisitError(f"--map {chosen.map}: 1 to 128 {LETTERS}")
    session = given("session")
    if session is not None and not (ID.fullmatch(session) and len(session) <= MAX_SESSION):
        raise RevisitError(f"--session {session}: 1 to {MAX_SESSION} {LETTERS}")
    if not 0 <= given("every_s", 0.0) < 1e6:
        raise RevisitError(f"--every-s {chosen.every_s}: seconds, not below 0")
    if given("focal_px") and given("calibration"):
        raise RevisitError("--focal-px: --calibration tells it")
    if given("no_query") and not chosen.output:
        raise RevisitError("--no-query: without -o FILE nothing would come of it")
    if given("no_query") and (chosen.server or chosen.report):
        raise RevisitError("--no-query: neither --server nor --report goes with it")
    sources = given("source", [])
    sources = [source.absolute() for source in (sources if isinstance(sources, list) else [sources])]
    for name in ("report", "output"):
        path = given(name)
        if path is not None and not path.absolute().parent.is_dir():
            raise RevisitError(f"--{name} {path}: no folder {path.absolute().parent}")
        if path is not None and path.absolute() in sources:
            raise RevisitError(f"--{name} {path}: that is the file itself")
        if path is not None and path.is_dir():
            raise RevisitError(f"--{name} {path}: a folder is there")


def terms(calibration: str) -> list[float]:
    """Return the numbers of --calibration: focal lengths, centre, and no, four or five terms of distortion."""
    try:
        values = [float(term) for term in calibration.split(",")]
    except ValueError:
        values = []
    if len(values) not in CALIBRATION_TERMS or not all(abs(value) < 1e6 for value in values) or min(values[:2]) <= 0:
        raise RevisitError(f"--calibration {calibration}: FX,FY,CX,CY, then nothing or K1,K2,P1,P2 or K1,K2,P1,P2,K3")
    return values
