"""Asking: the questions of each photograph under each protocol, and the answers."""

from __future__ import annotations

from dataclasses import dataclass

from ...client import Client
from ...models import LocateAnswer
from ..signs import judge
from .bodies import Bodies
from .collection import Shot
from .protocols import Excluded, excluded
from .sights import Sight

LOCATED = "located"
# Twenty pairs of pictures are compared for an answer, also where other programs take the machine's cores.
PATIENCE_S = 300.0


@dataclass(frozen=True)
class Asked:
    """A photograph, and the answer to each protocol's question."""

    shot: Shot
    answers: dict[str, LocateAnswer]


class Asking:
    """Asks one server about photographs."""

    def __init__(self, client: Client, bodies: Bodies, gallery: list[Shot], protocols: list[str]) -> None:
        self._client, self._bodies, self._gallery, self._protocols = client, bodies, gallery, protocols
        self._maps = sorted({shot.map for shot in gallery})

    def ask(self, sight: Sight) -> Asked:
        """Ask about one photograph. Protocols that leave out the same are one question."""
        signs = judge(sight.lines, sight.camera, ())
        known: dict[Excluded, LocateAnswer] = {}
        answers = {}
        for protocol in self._protocols:
            left_out = excluded(protocol, sight.shot, self._gallery)
            if left_out not in known:
                known[left_out] = self._client.locate(self._bodies.question(sight, signs, self._maps, left_out))
            answers[protocol] = known[left_out]
        return Asked(sight.shot, answers)
