"""Evidence: which signs of two pictures the decision on them rests on."""

from __future__ import annotations

from ..models import Candidate, EvidenceKind

AGAINST = (EvidenceKind.OTHER_NAME, EvidenceKind.STRANGE_NAMES, EvidenceKind.DISPLACED_NAME)


def agreeing(candidate: Candidate) -> list[tuple[str, str]]:
    """Return the pairs of anchors, the query's and the candidate's, that speak for one place."""
    if candidate.confidence is None:
        # Under the paper's method, which has no sum.
        matches = candidate.anchors.matches if candidate.anchors is not None else None
        return [(match.query_anchor, match.candidate_anchor) for match in matches or ()]
    return _pairs(candidate, (EvidenceKind.NAME, EvidenceKind.TEXTS))


def contradicting(candidate: Candidate) -> list[tuple[str, str]]:
    """Return the pairs of anchors that speak against it."""
    return _pairs(candidate, AGAINST)


def reads_another_name(candidate: Candidate) -> bool:
    """Return whether another name hangs at the same spot."""
    return bool(_pairs(candidate, (EvidenceKind.OTHER_NAME,)))


def _pairs(candidate: Candidate, kinds: tuple[EvidenceKind, ...]) -> list[tuple[str, str]]:
    terms = [term for term in candidate.evidence or () if term.kind in kinds]
    return [pair for term in terms for pair in zip(term.query_anchors or (), term.candidate_anchors or (), strict=True)]
