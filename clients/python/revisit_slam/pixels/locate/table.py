"""Table: the figures beside those of others, or the answers where no floor is known."""

from __future__ import annotations

from collections.abc import Sequence

from ..table import columns
from .asking import Asked
from .protocols import PROTOCOLS
from .reliability import reliability
from .score import Score

# As the authors of the collection print them: 504 photographs against 2,373, over their 25 labels. Protocol A.
# top-1, share for which a floor is answered, share of these that are right; in percent.
PRINTED = (
    ("ResNet-50", 46.8, None, None),
    ("DINOv2 ViT-S/14, 224 px", 49.2, None, None),
    ("DINOv2 ViT-B/14, 224 px", 49.4, None, None),
    ("DINOv2 ViT-S/14, 518 px", 52.8, 38.5, 80.4),
    ("EasyOCR alone", 4.2, 7.3, 56.8),
)
HEAD = ("", "protocol", "photographs", "located", "wrong floor", "first place right")


def score_table(scores: dict[str, Score], others: list[tuple[str, str, float]]) -> str:
    """Return the table of a run; `others` are the name, protocol and top-1 of ordinary methods on the same photographs."""
    rows = [
        (
            "Revisit",
            name,
            str(score.queries),
            f"{score.located} ({_percent(score.located, score.queries)})",
            str(score.wrong),
            f"{100 * score.top1:.1f} %",
        )
        for name, score in scores.items()
    ]
    for name, protocol, top1 in others:
        rows.append((name, protocol, str(scores[protocol].queries), "", "", f"{100 * top1:.1f} %"))
    lines = columns(HEAD, rows)
    lines += [f"  {name}: {PROTOCOLS[name]}" for name in scores]
    lines.append("as the authors of ie-tower-visual-place-recognition print them, over their 25 labels (not the same photographs):")
    printed = [
        (
            name,
            "A",
            "504",
            f"{answered} %" if answered is not None else "",
            f"{100 - right:.1f} % of these" if right is not None else "",
            f"{top1} %",
        )
        for name, top1, answered, right in PRINTED
    ]
    return "\n".join([*lines, *columns(HEAD, printed)])


def reliability_table(protocols: Sequence[str], asked: list[Asked]) -> str:
    """Return how many answers at or above a confidence are right, over some protocols together."""
    rows = [
        (f"{level.confidence:.2f}", str(level.answers), f"{level.right} ({_percent(level.right, level.answers)})")
        for level in reliability(protocols, asked)
    ]
    head = (f"confidence at least ({' and '.join(protocols)})", "answers", "right")
    return "\n".join(columns(head, rows))


def answer_table(asked: list[Asked], protocol: str) -> str:
    """Return the answers of a run without truth."""
    rows = []
    for one in asked:
        answer = one.answers[protocol]
        first = answer.places[0] if answer.places else None
        place = (first.map, first.keyframe or "") if first is not None else ("", "")
        rows.append((one.shot.frame.id, answer.verdict, f"{answer.confidence:.3f}", *place))
    return "\n".join(columns(("photograph", "verdict", "confidence", "map", "looks like"), rows))


def _percent(count: int, total: int) -> str:
    return f"{100 * count / total:.1f} %" if total else "-"
