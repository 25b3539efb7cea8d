"""revisit-play: from photographs to verdicts."""

from __future__ import annotations

import argparse
import contextlib
import signal
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec

from .arguments import check, parser
from .client import Client
from .errors import MAX_ERROR, RevisitError, one_line
from .needed import needed
from .problems import found
from .retries import Retries
from .server import Server

if TYPE_CHECKING:
    from .pixels.sources.source import Source

def main(arguments: list[str] | None = None) -> int:
    """Run the command; every expected failure is one line."""
    chosen = parser().parse_args(arguments)
    # A stop from outside must stop the server of the run as well.
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        check(chosen)
        commands = {"sample": _sample, "locate": _locate, "plan": _plan, "import": _import, "doctor": _doctor}
        return commands.get(chosen.command, _play)(chosen)
    except RevisitError as error:
        print(f"revisit-play: {one_line(error, MAX_ERROR)}", file=sys.stderr)
        return 1
    except BrokenPipeError:
        return 1
    except KeyboardInterrupt:
        print("revisit-play: stopped", file=sys.stderr)
        return 130


def _sample(chosen: argparse.Namespace) -> int:
    _need_pixels()
    from .sample.building import draw

    count = draw(chosen.folder)
    print(f"{count} photographs and truth.csv in {chosen.folder}; now: "
          f"revisit-play images {chosen.folder} --truth {chosen.folder / 'truth.csv'} --report report.html")
    return 0


def _plan(chosen: argparse.Namespace) -> int:
    from .plans.command import play_plans

    return play_plans(chosen)


def _import(chosen: argparse.Namespace) -> int:
    needed("numpy")
    from .imports.command import play_import

    return play_import(chosen, _settings(chosen.set))


def _doctor(chosen: argparse.Namespace) -> int:
    _need_pixels()
    from .doctor import doctor

    return doctor(chosen.source)


def _locate(chosen: argparse.Namespace) -> int:
    _need_pixels()
    from .pixels.locate.command import locate

    return locate(chosen)


def _play(chosen: argparse.Namespace) -> int:
    _need_pixels()
    from .pixels.sources.opening import open_source

    # Pictures out of films and bags are kept here for the run.
    with tempfile.TemporaryDirectory(prefix="revisit-play-") as work:
        return _play_source(chosen, open_source(chosen, Path(work)))


def _play_source(chosen: argparse.Namespace, source: Source) -> int:
    from .pixels.options import Options
    from .pixels.player import play
    from .pixels.recording import Recording
    from .pixels.table import table
    from .pixels.truth import Truth

    print(source.summary(), file=sys.stderr if chosen.json else sys.stdout, flush=True)
    truth = Truth(chosen.truth, source.frames) if chosen.truth else None
    options = Options(
        every_frame=chosen.every_frame,
        features=chosen.features,
        global_model=chosen.global_model,
        crops=not chosen.no_crops,
        focal_px=getattr(chosen, "focal_px", None),
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
            source,
            options,
            chosen.map,
            client=client,
            recording=recording,
            truth=truth,
            settings=_settings(chosen.set),
            names=chosen.names,
        )
    for told in (*source.checked().left_out.told(), *(truth.left_out.told() if truth is not None else ())):
        print(f"revisit-play: {told}", file=sys.stderr)
    if chosen.report:
        from .pixels.report import report

        try:
            chosen.report.write_text(report(run, truth, source), encoding="utf-8")
        except OSError as error:
            raise RevisitError(f"{chosen.report}: cannot be written: {error.strerror}") from error
    if chosen.json:
        print(msgspec.json.encode(run.score.figures(truth is not None)).decode())
    elif client is not None:
        print(table(run, truth))
    if chosen.server and not chosen.no_query:
        print(f"viewer: {chosen.server.rstrip('/')}/?map={chosen.map}", file=sys.stderr)
    if chosen.report:
        print(f"report: {chosen.report}", file=sys.stderr)
    if chosen.output:
        print(f"recording: {chosen.output}", file=sys.stderr)
    return 0


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
    # A wrong address is told at once, not after the retries that a long run has.
    with Client(url, key=key, retries=Retries(total_s=2.0)) as client:
        used = found(client.get_map, map)
    if used is not None and used.keyframes:
        raise RevisitError(f"map {map} has {used.keyframes} keyframes already: name another with --map, or delete it")


def _need_pixels() -> None:
    for module in ("numpy", "onnxruntime", "rapidocr"):
        needed(module, extra="read")
    needed("cv2", extra="read").setNumThreads(1)  # Results must not depend on the number of cores.


if __name__ == "__main__":
    sys.exit(main())
