"""revisit-play: from photographs to verdicts."""

from __future__ import annotations

import argparse
import contextlib
import os
import re
import signal
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import msgspec

from .client import Client
from .errors import RevisitError
from .retries import Retries
from .server import Server

ID = re.compile(r"[A-Za-z0-9._:-]{1,128}")


def parser() -> argparse.ArgumentParser:
    """Return the parser of the command line."""
    top = argparse.ArgumentParser(prog="revisit-play", description="Find the photographs that show the same place.")
    commands = top.add_subparsers(dest="command", required=True)
    images = commands.add_parser(
        "images",
        help="play a folder of photographs",
        description="Read the signs in a folder of photographs, send each as a keyframe, and ask for each whether its "
        "place was seen before. A video is the file's name before its number; names are sorted. Poses are rotations "
        "between overlapping photographs, without any distance. Without --server a server is started for the run "
        "($REVISIT_BINARY, beside this Python, or `revisit` on PATH).",
    )
    images.add_argument("folder", type=Path, metavar="FOLDER")
    images.add_argument("--every-frame", action="store_true", help="take every photograph, also those that overlap the last one")
    images.add_argument("--server", metavar="URL", help="post to this server")
    images.add_argument("--key", metavar="SECRET", default=os.environ.get("REVISIT_KEY"), help="API key of the server [$REVISIT_KEY]")
    images.add_argument("--map", metavar="ID", default="photographs", help="the map's id [photographs]")
    images.add_argument("-o", "--output", type=Path, metavar="FILE", help="also write a recording (.ndjson or .ndjson.zst)")
    images.add_argument("--no-query", action="store_true", help="with -o: write the recording only, no server")
    images.add_argument("--truth", type=Path, metavar="CSV", help="columns frame and floor: count right and wrong loops")
    images.add_argument("--json", action="store_true", help="print the figures as one JSON object, no table")
    images.add_argument("--report", type=Path, metavar="FILE", help="write a page with the pictures of each loop (.html)")
    images.add_argument("--cache", type=Path, metavar="DIR", help="keep what the reader read, for the next run")
    images.add_argument("--threads", type=int, metavar="N", default=os.cpu_count() or 1, help="photographs read at once [all cores]")
    images.add_argument("--features", action="store_true", help="also send features, for the server's geometry")
    images.add_argument(
        "--names", action="store_true", help="trust names with a number (Gate 7) as well; they often hang in several places"
    )
    images.add_argument("--no-crops", action="store_true", help="do not send the pictures of the signs")
    images.add_argument("--focal-px", type=float, metavar="PX", help="focal length in pixels [0.75 of the longer side]")
    images.add_argument(
        "--letter-height-m", type=float, metavar="M", help="assumed height of letters [0.1]; only bearings are compared"
    )
    images.add_argument(
        "--set", action="append", default=[], metavar="NAME=VALUE", help="a setting of the map; VALUE is JSON or a word"
    )
    sample = commands.add_parser("sample", help="draw a small building to try it on", description="Draw a small building "
        "with corridors that repeat, plates and exit signs: photographs, and truth.csv.")
    sample.add_argument("folder", type=Path, metavar="FOLDER")
    return top


def main(arguments: list[str] | None = None) -> int:
    """Run the command; every expected failure is one line."""
    chosen = parser().parse_args(arguments)
    # A stop from outside must stop the server of the run as well.
    signal.signal(signal.SIGTERM, _stop)
    try:
        return _images(chosen) if chosen.command == "images" else _sample(chosen)
    except RevisitError as error:
        print(f"revisit-play: {error}", file=sys.stderr)
        return 1
    except BrokenPipeError:
        return 1
    except KeyboardInterrupt:
        print("revisit-play: stopped", file=sys.stderr)
        return 130


def _stop(*_: object) -> None:
    raise KeyboardInterrupt


def _sample(chosen: argparse.Namespace) -> int:
    _need_pixels()
    from .sample import draw

    count = draw(chosen.folder)
    print(f"{count} photographs and truth.csv in {chosen.folder}; now: "
          f"revisit-play images {chosen.folder} --truth {chosen.folder / 'truth.csv'} --report report.html")
    return 0


def _images(chosen: argparse.Namespace) -> int:
    _need_pixels()
    _check(chosen)
    from .pixels.frames import list_frames
    from .pixels.options import Options
    from .pixels.player import play
    from .pixels.recording import Recording
    from .pixels.table import table
    from .pixels.truth import Truth

    frames = list_frames(chosen.folder)
    truth = Truth(chosen.truth, frames) if chosen.truth else None
    options = Options(
        every_frame=chosen.every_frame,
        features=chosen.features,
        crops=not chosen.no_crops,
        focal_px=chosen.focal_px,
        cache=chosen.cache,
        threads=chosen.threads,
        **({"letter_height_m": chosen.letter_height_m} if chosen.letter_height_m else {}),
    )
    with contextlib.ExitStack() as stack:
        client = None
        if not chosen.no_query:
            url = chosen.server or stack.enter_context(Server()).url
            client = stack.enter_context(Client(url, key=chosen.key))
            if chosen.server:
                _refuse_used_map(url, chosen.key, chosen.map)
        recording = stack.enter_context(Recording(chosen.output)) if chosen.output else None
        run = play(
            frames,
            options,
            chosen.map,
            client=client,
            recording=recording,
            truth=truth,
            settings=_settings(chosen.set),
            names=chosen.names,
            progress=_progress(),
        )
    if chosen.report:
        from .pixels.report import report

        try:
            chosen.report.write_text(report(run, truth, str(chosen.folder)), encoding="utf-8")
        except OSError as error:
            raise RevisitError(f"{chosen.report}: cannot be written: {error.strerror}") from error
    if chosen.json:
        print(msgspec.json.encode(run.score.figures(truth is not None)).decode())
    elif client is not None:
        print(table(run, truth))
    if chosen.report:
        print(f"report: {chosen.report}", file=sys.stderr)
    if chosen.output:
        print(f"recording: {chosen.output}", file=sys.stderr)
    return 0


def _check(chosen: argparse.Namespace) -> None:
    if not ID.fullmatch(chosen.map):
        raise RevisitError(f"--map {chosen.map}: 1 to 128 letters, digits, dots, underscores, colons or hyphens")
    if chosen.threads < 1:
        raise RevisitError(f"--threads {chosen.threads}: at least 1")
    for name in ("focal_px", "letter_height_m"):
        value = getattr(chosen, name)
        if value is not None and not 0 < value < 1e6:
            raise RevisitError(f"--{name.replace('_', '-')} {value}: a positive number")
    if chosen.no_query and not chosen.output:
        raise RevisitError("--no-query: without -o FILE nothing would come of it")
    if chosen.no_query and (chosen.server or chosen.report):
        raise RevisitError("--no-query: neither --server nor --report goes with it")
    for name in ("report", "output"):
        path = getattr(chosen, name)
        if path is not None and not path.absolute().parent.is_dir():
            raise RevisitError(f"--{name} {path}: no folder {path.absolute().parent}")


def _settings(pairs: list[str]) -> dict[str, Any]:
    settings = {}
    for pair in pairs:
        name, equals, value = pair.partition("=")
        if not equals or not name:
            raise RevisitError(f"--set {pair}: NAME=VALUE is expected")
        try:
            settings[name] = msgspec.json.decode(value)
        except msgspec.DecodeError:
            settings[name] = value
    return settings


def _refuse_used_map(url: str, key: str | None, map: str) -> None:
    """Keep two folders out of one map by mistake: ids of one would contradict those of the other."""
    from .problems import ProblemError

    try:
        # A wrong address is told at once, not after the retries that a long run has.
        with Client(url, key=key, retries=Retries(total_s=2.0)) as client:
            count = client.get_map(map).keyframes
    except ProblemError as problem:
        if problem.status == 404:
            return
        raise
    if count:
        raise RevisitError(f"map {map} has {count} keyframes already: name another with --map, or delete it")


def _need_pixels() -> None:
    try:
        import cv2  # noqa: F401
        import numpy  # noqa: F401
        import onnxruntime  # noqa: F401
        import rapidocr  # noqa: F401
    except ImportError as error:
        raise RevisitError(f"{error.name} is missing: install the package with its extra, revisit-slam[read]") from error
    cv2.setNumThreads(1)  # Results must not depend on the number of cores.


def _progress() -> Callable[[int, int, int], None] | None:
    if not sys.stderr.isatty():
        return None

    def show(done: int, total: int, loops: int) -> None:
        filled = 30 * done // total
        end = "\n" if done == total else ""
        print(f"\r[{'#' * filled}{'.' * (30 - filled)}] {done} of {total} photographs, {loops} loops ", end=end, file=sys.stderr, flush=True)

    return show


if __name__ == "__main__":
    sys.exit(main())
