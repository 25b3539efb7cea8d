"""Report: one page with the pictures of each loop, and of the look-alikes that are none. It needs no other file."""

from __future__ import annotations

import base64
from dataclasses import dataclass
from html import escape

import cv2

from ..errors import RevisitError
from ..models import Candidate
from .evidence import agreeing, contradicting
from .player import Run, Seen
from .signs import Sign
from .sources.source import Source
from .table import because, mark
from .truth import Truth

MAX_LOOPS = 100
MAX_REJECTED = 40
PICTURE_PX = 560
STYLE = """
body{font:15px/1.5 system-ui,sans-serif;margin:2em auto;max-width:1180px;padding:0 1em;color:#222;background:#fafafa}
h1{font-size:1.5em;margin-bottom:.2em} h2{font-size:1.15em;margin-top:2.2em;border-bottom:1px solid #ccc}
article{background:#fff;border:1px solid #ddd;border-radius:6px;padding:1em;margin:1.2em 0}
article>p{margin:.1em 0 .8em} .pair{display:flex;gap:1em;flex-wrap:wrap} figure{margin:0;flex:1 1 420px;min-width:0}
figure div{position:relative} img,svg{display:block;width:100%;height:auto} svg{position:absolute;inset:0;height:100%}
rect{fill:none;stroke:#8a8a8a;stroke-width:2;vector-effect:non-scaling-stroke} rect.agree{stroke:#0a8f3c;stroke-width:3}
rect.against{stroke:#d22;stroke-width:3} figcaption{font-size:.85em;color:#444;overflow-wrap:anywhere}
.agree{color:#0a7a33} .against{color:#c11} .unsure{color:#888} .loop b{color:#0a7a33} .none b{color:#c11}
table{border-collapse:collapse} td,th{padding:.1em 1em .1em 0;text-align:left;font-weight:normal} td{font-variant-numeric:tabular-nums}
.tag{font-size:.8em;border:1px solid #bbb;border-radius:3px;padding:0 .4em;margin-left:.6em}
"""


@dataclass(frozen=True)
class Side:
    """Anchors of one picture that agree with the other, and those that contradict it."""

    agree: set[str]
    against: set[str]

    def kind(self, anchor: str | None) -> str:
        """Return the style of an anchor's box."""
        return "agree" if anchor in self.agree else "against" if anchor in self.against else "other"


def report(run: Run, truth: Truth | None, source: Source) -> str:
    """Return the page."""
    loops, rejected, title = run.loops(), run.rejected(), source.title
    parts = [
        f"<!doctype html><html lang=en><meta charset=utf-8><meta name=viewport content='width=device-width'>"
        f"<title>Loops in {escape(title)}</title><style>{STYLE}</style>",
        f"<h1>Loops in {escape(title)}</h1>",
        f"<p>{escape(source.summary())}</p>",
        "<p>Found by Revisit. <span class=agree>Green</span> boxes agree, <span class=against>red</span> ones contradict, "
        "grey ones decide nothing.</p>",
        _figures(run, truth),
        f"<h2>Same place ({len(loops)})</h2>",
    ]
    parts += [_pair(run, truth, seen, best) for seen, best in sorted(loops, key=_surest_first)[:MAX_LOOPS]]
    if len(loops) > MAX_LOOPS:
        parts.append(f"<p>The first {MAX_LOOPS} of {len(loops)} are shown.</p>")
    parts.append(f"<h2>Look-alikes that are no loop, or not for certain ({min(len(rejected), MAX_REJECTED)} of {len(rejected)})</h2>")
    parts.append("<p>One for each two videos: those with another name at the same spot first, then by likeness.</p>")
    parts += [_pair(run, truth, seen, candidate) for seen, candidate in rejected[:MAX_REJECTED]]
    return "\n".join(parts) + "\n</html>\n"


def _surest_first(found: tuple[Seen, Candidate]) -> tuple[float, str]:
    seen, best = found
    return -(best.confidence or 0.0), seen.frame.id


def _figures(run: Run, truth: Truth | None) -> str:
    rows = [("photographs asked", run.score.queries), ("loops", run.score.accepted)]
    if truth is not None:
        rows += [
            ("right (another video, or ten frames away)", run.score.right),
            ("to a wrong place", run.score.wrong),
        ]
    rows += [(f"not a loop: {code}", count) for code, count in run.reasons().items()]
    return "<table>" + "".join(f"<tr><td>{count}<th>{escape(name)}" for name, count in rows) + "</table>"


def _pair(run: Run, truth: Truth | None, seen: Seen, candidate: Candidate) -> str:
    other = run.seen[candidate.keyframe]
    here, there = Side(set(), set()), Side(set(), set())
    for own, others in agreeing(candidate):
        here.agree.add(own)
        there.agree.add(others)
    # In a loop it was outweighed: what decided is shown.
    for own, others in contradicting(candidate) if candidate.verdict != "loop" else ():
        here.against.add(own)
        there.against.add(others)
    if candidate.verdict == "loop":
        kind, head = "loop", "Same place"
        why = because(seen, candidate)
    else:
        kind, head = "none", "Not the same place" if candidate.verdict == "rejected" else "Undecided"
        why = candidate.reason.detail if candidate.reason else ""
    tag = mark(truth, seen, candidate) if candidate.verdict == "loop" else ""
    if truth is not None and not tag:
        tag = "the same floor in truth" if truth.same_floor(seen.frame.id, candidate.keyframe) else "another floor in truth"
    tag = f"<span class=tag>{escape(tag)}</span>" if tag else ""
    return (
        f"<article class={kind}><p><b>{head}</b>: {escape(why)}{tag}</p><div class=pair>"
        + _picture(run, seen, here)
        + _picture(run, other, there)
        + "</div></article>"
    )


def _picture(run: Run, seen: Seen, side: Side) -> str:
    try:
        image = seen.frame.view().image
    except RevisitError:
        return f"<figure><figcaption>{escape(seen.frame.id)}: its picture is gone</figcaption></figure>"
    height, width = image.shape[:2]
    scale = min(1.0, PICTURE_PX / width)
    small = cv2.resize(image, (round(width * scale), round(height * scale)), interpolation=cv2.INTER_AREA)
    data = base64.b64encode(cv2.imencode(".jpg", small, [cv2.IMWRITE_JPEG_QUALITY, 72])[1].tobytes()).decode()
    boxes, texts, inside = [], [], set()
    for sign, anchor in seen.signs:
        kind = side.kind(anchor)
        inside.add(anchor)
        x0, y0, x1, y1 = sign.box
        boxes.append(
            f"<rect class='{kind}' x={x0} y={y0} width={round(x1 - x0, 1)} height={round(y1 - y0, 1)}>"
            f"<title>{escape(sign.text)}</title></rect>"
        )
        texts.append(_text(sign, kind))
    # A sign may stand in a neighbouring picture only.
    for anchor in sorted((side.agree | side.against) - inside):
        if anchor in run.anchors:
            where, sign = run.anchors[anchor]
            texts.append(f"<span class={side.kind(anchor)}>{escape(sign.text)}</span> (in {escape(where)})")
    return (
        f"<figure><div><img src='data:image/jpeg;base64,{data}' alt='{escape(seen.frame.id)}'>"
        f"<svg viewBox='0 0 {width} {height}' preserveAspectRatio='none'>{''.join(boxes)}</svg></div>"
        f"<figcaption>{escape(seen.frame.id)}<br>{', '.join(texts) or 'nothing read'}</figcaption></figure>"
    )


def _text(sign: Sign, kind: str) -> str:
    note = f"{sign.confidence:.2f}, {sign.evidence}"
    if sign.other_reading:
        note += f"; the other reading: {sign.other_reading}"
    unsure = " unsure" if sign.confidence < 0.8 else ""
    return f"<span class='{kind}{unsure}' title='{escape(note, quote=True)}'>{escape(sign.text)}</span>"
