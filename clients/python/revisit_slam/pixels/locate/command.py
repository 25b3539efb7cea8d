"""The command `revisit-play locate`: from folders of photographs to the table."""

from __future__ import annotations

import argparse
import contextlib
import sys

import msgspec

from ...client import Client
from ...errors import RevisitError
from ...left_out import LeftOut
from ...problems import found
from ...server import Server
from ..ahead import ahead, progress
from ..global_descriptors import MODELS
from ..options import Options
from ..training import train_vocabulary
from ..vocabulary import Vocabulary
from .asking import PATIENCE_S, Asked, Asking
from .bodies import Bodies
from .collection import Collection, Shot, open_collection
from .gallery import send_gallery
from .gradients import Binariser
from .ordinary import Figures, Ordinary
from .protocols import PROTOCOLS
from .reliability import reliability
from .score import Score
from .sights import Sight, look
from .table import answer_table, reliability_table, score_table

# The channels that propose candidates; signs are a third one, with --signs.
WORDS, GLOBAL = "words", "global"
# The place of a photograph is in the gallery under A and B, and nearly never under C.
POOLED = (("A", "B"), ("C",))
# Where no floor is known there is no split either, and the gallery has nothing to leave out.
UNJUDGED = ["A"]


def locate(chosen: argparse.Namespace) -> int:
    """Run the command."""
    collection = open_collection(chosen.gallery, chosen.queries, chosen.truth)
    protocols = list(PROTOCOLS) if collection.is_judged else UNJUDGED
    gallery = _look(chosen, "gallery", collection.gallery, collection.left_out)
    vocabulary = _vocabulary(gallery)
    bodies = Bodies(vocabulary, Binariser(sight.gradients for sight in gallery), WORDS in chosen.channels)
    with contextlib.ExitStack() as stack:
        url = chosen.server or stack.enter_context(Server()).url
        client = stack.enter_context(Client(url, key=chosen.key, timeout_s=PATIENCE_S))
        if chosen.server:
            _refuse_used_maps(client, collection)
        send_gallery(client, gallery, bodies, chosen.threads)
        queries = _look(chosen, "queries", collection.queries, collection.left_out, chosen.distort)
        asking = Asking(client, bodies, [sight.shot for sight in gallery], protocols)
        asked = list(ahead(queries, asking.ask, chosen.threads, progress("asked", len(queries))))
    others = _ordinary(chosen, gallery, queries) if chosen.orb and collection.is_judged else []
    print(_printed(chosen, collection, asked, others))
    for told in collection.left_out.told():
        print(f"revisit-play: {told}", file=sys.stderr)
    return 0


def _ordinary(chosen: argparse.Namespace, gallery: list[Sight], queries: list[Sight]) -> Figures:
    vocabulary = train_vocabulary([sight.tracking.descriptors for sight in gallery])
    return Ordinary(gallery, vocabulary).figures(queries, chosen.threads, progress("compared by ORB", len(queries)))


def _printed(chosen: argparse.Namespace, collection: Collection, asked: list[Asked], others: Figures) -> str:
    if not collection.is_judged:
        if not chosen.json:
            return answer_table(asked, UNJUDGED[0])
        answers = [{"photograph": one.shot.frame.id, **msgspec.to_builtins(one.answers[UNJUDGED[0]])} for one in asked]
        return msgspec.json.encode({"answers": answers}).decode()
    scores = {protocol: Score.of(protocol, asked) for protocol in PROTOCOLS}
    if not chosen.json:
        return "\n".join([score_table(scores, others), *(reliability_table(of, asked) for of in POOLED)])
    levels = {"+".join(of): reliability(of, asked) for of in POOLED}
    return msgspec.json.encode({"protocols": scores, "reliability": levels}).decode()


def _look(
    chosen: argparse.Namespace, what: str, shots: list[Shot], left_out: LeftOut, distortion: str | None = None
) -> list[Sight]:
    model = MODELS[0] if GLOBAL in chosen.channels else None
    options = Options(global_model=model, focal_px=chosen.focal_px, cache=chosen.cache, threads=chosen.threads)
    sights = look(shots, options, left_out, chosen.signs, distortion, progress(what, len(shots)))
    if not sights:
        raise RevisitError("; ".join((f"no photograph of the {what} can be read", *left_out.told())))
    return sights


def _vocabulary(gallery: list[Sight]) -> Vocabulary:
    documents = [sight.words.descriptors for sight in gallery]
    if not any(len(one) for one in documents):
        raise RevisitError(f"--gallery: no features in its {len(documents)} photographs: they are blank")
    return train_vocabulary(documents)


def _refuse_used_maps(client: Client, collection: Collection) -> None:
    """Keep the gallery apart from maps that others made."""
    for map in collection.maps:
        used = found(client.get_map, map)
        if used is not None and used.keyframes:
            raise RevisitError(f"map {map} has {used.keyframes} keyframes already: delete it, or name another --server")
