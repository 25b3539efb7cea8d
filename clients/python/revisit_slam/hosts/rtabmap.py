"""RTAB-Map, live: `MapData` and `Info` come in, links for its `AddLink` go out."""

from __future__ import annotations

import logging
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..imports.damage import Account
from ..imports.limits import MAX_KEYFRAMES
from ..imports.poses import apart, inverse, moved
from ..imports.poses import body as pose_body
from ..imports.rtabmap.messages import Graph, graph_of, observation_of
from ..imports.rtabmap.node import LOOPS, NEIGHBOUR, NEIGHBOUR_MERGED, USER_CLOSURE
from .bridge import Bridge
from .loops import Edge, Loop, Trust, edge_of, inverse_jacobian

# Nodes whose poses and points follow RTAB-Map's optimiser; 500 points of a node take 12 KB.
MAX_FOLLOWED = 20_000
CONSECUTIVE = {NEIGHBOUR, NEIGHBOUR_MERGED}
# A node that moved less stays where it is.
MOVED_M, TURNED_RAD = 0.01, 0.005
# One correction's nodes; with 1,000 points each, within what the server takes.
NODES_A_CORRECTION = 64


@dataclass(eq=False)
class Followed:
    """A node that was sent."""

    id: int
    name: str
    session: str
    stamp_ns: int
    base_from_camera: np.ndarray
    map_from_base: np.ndarray
    """As the server has it."""
    point_ids: list[int]
    points_in_base: np.ndarray
    queued: np.ndarray | None = None
    """What it is being corrected to."""


@dataclass(frozen=True, eq=False)
class Link:
    """A link between two nodes: where the base of `to` is in that of `from`, the information of it, and the same as an edge."""

    from_id: int
    to_id: int
    from_from_to: np.ndarray
    information: np.ndarray
    edge: Edge
    type: int = USER_CLOSURE


class RtabmapBridge:
    """Joins one RTAB-Map and one map of the server. Its methods return at once, and may be called by any executor."""

    def __init__(self, bridge: Bridge, name: str, trust: Trust | None = None) -> None:
        self._bridge, self._name, self._trust = bridge, name, trust or Trust()
        # Only the thread of messages changes it; the executor reads it.
        self._followed: dict[int, Followed] = {}
        self._by_name: dict[str, Followed] = {}
        # Of every node that was sent.
        self._names: dict[int, str] = {}
        # Of every node the keyframe that it is, or those before it where it is none.
        self._reached: dict[int, set[str]] = {}
        self._offered: dict[frozenset[int], Loop] = {}
        self._confirmed: set[frozenset[int]] = set()

    def on_map_data(self, message: Any) -> None:
        """Take a `MapData`."""
        self._bridge.leave(lambda: self._map_data(message))

    def on_info(self, message: Any) -> None:
        """Take an `Info`: the loops that RTAB-Map closed by itself."""
        if message.loop_closure_id > 0 and message.ref_id > 0:
            one, other = int(message.ref_id), int(message.loop_closure_id)
            self._bridge.leave(lambda: self._closed(one, other))

    def take_links(self) -> list[Link]:
        """Return the links found since the last call, from the newer node to the older one, as RTAB-Map makes them."""
        links = []
        for loop in self._bridge.take_loops():
            query, candidate = self._by_name.get(loop.query), self._by_name.get(loop.candidate)
            # A candidate of another run is no node of this RTAB-Map.
            if query is None or candidate is None:
                continue
            link = self._link(loop, query, candidate)
            if link is not None:
                self._offered[frozenset((query.id, candidate.id))] = loop
                links.append(link)
        return links

    def _link(self, loop: Loop, query: Followed, candidate: Followed) -> Link | None:
        stamps_ns = (query.stamp_ns, candidate.stamp_ns)
        edge = edge_of(loop, stamps_ns, query.base_from_camera, candidate.base_from_camera, self._trust)
        if edge is None:
            return None
        back = inverse_jacobian(edge.to_from_from)
        information = np.linalg.inv(back @ edge.covariance @ back.T)
        return Link(query.id, candidate.id, inverse(edge.to_from_from), information, edge)

    def _map_data(self, message: Any) -> None:
        # The next message has the graph again, and is to be told of again.
        account = Account("MapData")
        graph = graph_of(message.graph, account, "MapData")
        for node in message.nodes:
            with account.part(f"node {node.id}") as where:
                self._node(node, graph, where)
        self._accepted(graph)
        self._correct(graph)
        for line in account.told():
            logging.getLogger(__name__).warning("MapData: %s", line)

    def _node(self, node: Any, graph: Graph, where: str) -> None:
        id = int(node.id)
        if id in self._names or len(self._names) >= MAX_KEYFRAMES:
            return
        seen = observation_of(node, graph, self._name, where)
        linked = [other if one == id else one for one, other, kind in graph.links if id in (one, other) and kind in CONSECUTIVE]
        # Of loops the server is asked; that consecutive nodes see the same it need not find out.
        near = {name for other in linked for name in self._reached.get(other, ())}
        if seen is None:
            # A node that is no keyframe: what is linked with it is so with those before it.
            self._reached[id] = near
            return
        seen.covisible.update(dict.fromkeys(near, 1))
        if not self._bridge.send(seen.id, seen.body()):
            return
        self._names[id] = seen.id
        self._reached[id] = {seen.id}
        if len(self._followed) >= MAX_FOLLOWED:
            return
        map_from_base = graph.poses.get(id)
        if map_from_base is None:
            return
        ids = list(seen.placed)
        in_map = np.array([seen.placed[point] for point in ids], float).reshape(-1, 3)
        base_from_camera = inverse(map_from_base) @ seen.session_from_camera
        points = moved(inverse(map_from_base), in_map).astype(np.float32)
        followed = Followed(id, seen.id, seen.session, seen.stamp_ns, base_from_camera, map_from_base, ids, points)
        self._followed[id] = self._by_name[seen.id] = followed

    def _accepted(self, graph: Graph) -> None:
        """Confirm the loops whose links RTAB-Map took; `AddLink` itself answers nothing."""
        for one, other, kind in graph.links:
            if kind in LOOPS and frozenset((one, other)) in self._offered:
                self._closed(one, other)

    def _closed(self, one: int, other: int) -> None:
        pair = frozenset((one, other))
        newer, older = self._followed.get(max(one, other)), self._followed.get(min(one, other))
        if pair in self._confirmed or newer is None or older is None:
            return
        self._confirmed.add(pair)
        offered = self._offered.pop(pair, None)
        self._bridge.confirm(f"{newer.name}-{older.id}", newer.name, older.name, offered.answer if offered else None)

    def _correct(self, graph: Graph) -> None:
        """Send the poses that the optimiser changed, with the points that hang on them."""
        changed: dict[str, list[tuple[Followed, np.ndarray]]] = {}
        for id, map_from_base in graph.poses.items():
            node = self._followed.get(id)
            if node is None or not self._bridge.is_stored(node.name):
                continue
            distance_m, turn_rad = apart(node.map_from_base if node.queued is None else node.queued, map_from_base)
            if distance_m > MOVED_M or turn_rad > TURNED_RAD:
                changed.setdefault(node.session, []).append((node, map_from_base))
        for session, nodes in changed.items():
            for start in range(0, len(nodes), NODES_A_CORRECTION):
                self._send_correction(session, nodes[start : start + NODES_A_CORRECTION])

    def _send_correction(self, session: str, nodes: list[tuple[Followed, np.ndarray]]) -> None:
        ids = [point for node, _ in nodes for point in node.point_ids]
        places = [moved(pose, node.points_in_base.astype(float)) for node, pose in nodes]
        body: dict[str, Any] = {
            "keyframes": {
                "ids": [node.name for node, _ in nodes],
                "poses": [pose_body(pose @ node.base_from_camera) for node, pose in nodes],
            }
        }
        if ids:
            body["map_points"] = {"ids": ids, "positions": np.concatenate(places).tolist()}

        def done(taken: bool) -> None:
            for node, pose in nodes:
                if taken:
                    node.map_from_base = pose
                if node.queued is pose:
                    node.queued = None

        for node, pose in nodes:
            node.queued = pose
        self._bridge.correct(session, body, done)
