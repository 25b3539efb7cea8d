"""Table: what a run found, for a terminal."""

from __future__ import annotations

from collections.abc import Sequence

from ..models import Candidate
from .player import Run, Seen
from .truth import Truth

MAX_LOOPS = 200
MAX_REJECTED = 20


def because(seen: Seen, best: Candidate) -> str:
    """Return what a loop rests on."""
    inliers = f" {best.geometry.inliers} points fit." if best.geometry.status == "verified" else ""
    return f"{seen.answer.why}{inliers}" if seen.answer is not None else ""


def table(run: Run, truth: Truth | None) -> str:
    """Return the table of loops, of look-alikes that are none, and of reasons."""
    lines = []
    loops = run.loops()
    if loops:
        lines.append("loops:")
        rows = [(seen.frame.id, best.keyframe, mark(truth, seen, best), because(seen, best)) for seen, best in loops]
        lines += columns(("photograph", "same place as", "truth" if truth else "", "because"), rows[:MAX_LOOPS])
        if len(rows) > MAX_LOOPS:
            lines.append(f"  ... and {len(rows) - MAX_LOOPS} more")
    rejected = run.rejected()[:MAX_REJECTED]
    if rejected:
        lines.append("look-alikes that are no loop, or not for certain:")
        rows = [
            (seen.frame.id, candidate.keyframe, str(candidate.verdict), candidate.reason.detail if candidate.reason else "")
            for seen, candidate in rejected
        ]
        lines += columns(("photograph", "looks like", "", "why not"), rows)
    reasons = run.reasons()
    if reasons:
        lines.append("why the others are no loop: " + ", ".join(f"{code} {count}" for code, count in reasons.items()))
    score = run.score
    lines.append(f"{score.queries} photographs asked, {score.accepted} loops, {score.seconds} s")
    if truth is not None:
        lines.append(f"right {score.right}, wrong {score.wrong}, answers that name a wrong place {score.loops_wrong}")
    return "\n".join(lines)


def mark(truth: Truth | None, seen: Seen, best: Candidate) -> str:
    """Return right, wrong or near for a loop; near is the same passage."""
    if truth is None:
        return ""
    if truth.right(seen.frame.id, best.keyframe):
        return "right"
    return "near" if truth.same_floor(seen.frame.id, best.keyframe) else "WRONG"


def columns(head: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """Return lines of cells under a head, each column as wide as its widest cell."""
    widths = [max(len(row[column]) for row in [head, *rows]) for column in range(len(head))]
    return [
        "  " + "  ".join(cell.ljust(width) for cell, width in zip(row, widths) if width).rstrip() for row in [head, *rows]
    ]
