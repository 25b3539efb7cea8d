"""Player: posts keyframes, asks each right after it arrived, and keeps the answers."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

from ..client import Client
from ..models import Candidate, LoopAnswer
from .ahead import progress
from .evidence import reads_another_name
from .frames import Frame
from .keyframes import Keyframe, keyframes
from .options import Options
from .recording import Recording
from .signs import SIGN_CLASS, Sign
from .sources.source import Source
from .truth import Score, Truth


@dataclass(frozen=True)
class Seen:
    """A keyframe that was sent: its signs with their anchors, and the verdict."""

    frame: Frame
    signs: list[tuple[Sign, str | None]]
    answer: LoopAnswer | None


@dataclass
class Run:
    """All that came of a run."""

    score: Score = field(default_factory=Score)
    seen: dict[str, Seen] = field(default_factory=dict)
    # Each anchor's first sighting: the keyframe and the sign.
    anchors: dict[str, tuple[str, Sign]] = field(default_factory=dict)

    def loops(self) -> list[tuple[Seen, Candidate]]:
        """Return the accepted queries with their best candidate."""
        found = []
        for seen in self.seen.values():
            if seen.answer is not None and seen.answer.verdict == "loop":
                best = next((c for c in seen.answer.candidates if c.keyframe == seen.answer.best), None)
                if best is not None:
                    found.append((seen, best))
        return found

    def rejected(self) -> list[tuple[Seen, Candidate]]:
        """Return look-alikes that were rejected or left open: those with another name at the same spot first, then by likeness; one a pair of videos."""
        pairs = [
            (seen, candidate)
            for seen in self.seen.values()
            if seen.answer is not None
            for candidate in seen.answer.candidates
            if candidate.verdict != "loop" and candidate.reason is not None and candidate.keyframe in self.seen
        ]
        pairs.sort(key=lambda pair: (not reads_another_name(pair[1]), -_likeness(pair[1]), pair[0].frame.id, pair[1].keyframe))
        chosen, taken = [], set()
        for seen, candidate in pairs:
            key = (seen.frame.video, self.seen[candidate.keyframe].frame.video)
            if key not in taken:
                taken.add(key)
                chosen.append((seen, candidate))
        return chosen

    def reasons(self) -> dict[str, int]:
        """Return how many queries ended for which reason, most first."""
        answers = [seen.answer for seen in self.seen.values() if seen.answer is not None]
        counts = Counter(deciding_reason(answer) for answer in answers if answer.verdict != "loop")
        return dict(sorted(counts.items(), key=lambda item: (-item[1], item[0])))


def _likeness(candidate: Candidate) -> float:
    # Left out by servers for candidates that words did not propose.
    return candidate.bow.score if candidate.bow is not None else 0.0


def deciding_reason(answer: LoopAnswer) -> str:
    """Return the code of the reason why an answer is not a loop."""
    if answer.reason is not None:
        return answer.reason.code
    same = [c for c in answer.candidates if c.reason is not None and c.verdict == answer.verdict]
    same = same or [c for c in answer.candidates if c.reason is not None]
    return same[0].reason.code if same and same[0].reason is not None else str(answer.verdict)


def play(
    source: Source,
    options: Options,
    map_id: str,
    *,
    client: Client | None = None,
    recording: Recording | None = None,
    truth: Truth | None = None,
    settings: dict[str, Any] | None = None,
    names: bool = False,
) -> Run:
    """Play photographs to a server, a recording, or both."""
    begun = time.monotonic()
    run = Run()
    body: dict[str, Any] = {"description": "Photographs, by revisit-play", "metric": source.metric}
    if not names:
        body["anchor_classes"] = [SIGN_CLASS]
    if settings:
        body["settings"] = settings
    if recording is not None:
        recording.write("map", id=map_id, body=body)
    if client is not None:
        client.put_map(map_id, body)
    show = progress("photographs", len(source.frames))
    done = {frame.id: number for number, frame in enumerate(source.frames, 1)}
    for keyframe in keyframes(source.frames, options, source.left_out):
        id = keyframe.frame.id
        if recording is not None:
            recording.write("keyframe", id=id, body=keyframe.body)
            recording.query(id, truth.lists(id, run.seen) if truth is not None else None)
        run.seen[id] = _send(client, map_id, keyframe, run)
        answer = run.seen[id].answer
        if answer is not None:
            run.score.count(truth, id, answer.verdict, answer.best, answer.loops)
        show(done[id])
    run.score.seconds = round(time.monotonic() - begun, 1)
    return run


def _send(client: Client | None, map_id: str, keyframe: Keyframe, run: Run) -> Seen:
    if client is None:
        return Seen(keyframe.frame, [(sign, None) for sign in keyframe.signs], None)
    answer = client.put_keyframe(map_id, keyframe.frame.id, keyframe.body, query="loop")
    anchors: Iterable[str | None] = (outcome.anchor for outcome in answer.detections)
    signs = list(zip(keyframe.signs, anchors))
    for sign, anchor in signs:
        if anchor is not None:
            run.anchors.setdefault(anchor, (keyframe.frame.id, sign))
    return Seen(keyframe.frame, signs, answer.loop)
