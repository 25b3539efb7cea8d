"""`rtabmap_msgs/MapData` in a ROS 2 recording: nodes as they came, with the poses of the last graph."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from ...errors import RevisitError
from ...files import how_to_mend
from ..bag import Bag, opened_bag
from ..damage import Account, told_of
from ..limits import MAX_KEYFRAMES, MAX_PIECE_BYTES
from ..observation import Observation
from ..opened import Opened, Wanted
from ..sqlite_file import not_ended
from .chunks import check_chunks
from .definitions import MAP_DATA, typestore
from .messages import Graph, graph_of, observation_of
from .node import Nodes


def open_map(path: Path, wanted: Wanted) -> Opened:
    """Open a recording."""
    account = Account(path)
    if path.is_dir() and not (path / "metadata.yaml").is_file():
        raise RevisitError(f"{path}: no metadata.yaml in it: {how_to_mend(path)}")
    with told_of(path, "the reader of MCAP"):
        for part in sorted(part for part in path.iterdir() if part.suffix in (".mcap", ".db3")) if path.is_dir() else [path]:
            if part.suffix == ".db3" and not_ended(part):
                raise RevisitError(f"{part}: {not_ended(part)}")
            check_chunks(part)
    with opened_bag(path, [path], typestore(), account.left_out) as bag:
        topic = bag.one("--topic", wanted.topic, (MAP_DATA,))
        if topic is None:
            raise RevisitError(f"{path}: no {MAP_DATA} in it; it has {bag.told()}")

    def keyframes() -> Iterator[Observation]:
        with opened_bag(path, [path], typestore(), account.left_out) as bag:
            yield from _keyframes(bag, topic, wanted.name(path), account)

    return Opened("RTAB-Map's MapData", True, keyframes, account)


def _messages(bag: Bag, topic: str) -> Iterator[bytes]:
    for _, _, data in bag.raw(topic):
        if len(data) > MAX_PIECE_BYTES:
            raise RevisitError(f"{topic}: a message of {len(data)} bytes; at most {MAX_PIECE_BYTES >> 20} MiB are taken")
        yield data


def _keyframes(bag: Bag, topic: str, name: str, account: Account) -> Iterator[Observation]:
    final = _last_graph(bag, topic, account)
    neighbours = _neighbours(final)
    nodes, came = Nodes(), set[int]()
    left_graph = 0
    for number, data in enumerate(_messages(bag, topic), 1):
        with account.part(f"message {number} of {topic}") as whole:
            message = _message(bag, data, whole)
            graph: Graph | None = None
            for node in message.nodes:
                id = int(node.id)
                if id in came:
                    continue
                if len(came) >= MAX_KEYFRAMES:
                    raise RevisitError(f"{bag.file}: it has more than {MAX_KEYFRAMES} nodes; so many are not taken")
                came.add(id)
                with account.part(f"node {id}") as where:
                    here, near = final, neighbours.get(id, [])
                    if id not in final.poses:
                        # A node that left the graph stands where the graph had it when it came.
                        graph = graph or graph_of(message.graph, account, whole)
                        here, near = graph, _neighbours(graph).get(id, [])
                    seen = observation_of(node, here, name, where)
                    if seen is None:
                        raise RevisitError(f"{where}: without a pose, or between keyframes")
                    left_graph += here is not final
                    nodes.join(id, seen, near)
                    yield seen
                if id not in nodes.names:
                    nodes.leave_out(id, near)
    if left_graph:
        are = "node is" if left_graph == 1 else "nodes are"
        account.notes.append(f"{left_graph} {are} not in the last graph: they stand where they stood when they came")


def _message(bag: Bag, data: bytes, where: str) -> Any:
    try:
        return bag.reader.deserialize(data, MAP_DATA)
    except Exception as error:  # noqa: BLE001 - it raises types of its own
        raise RevisitError(f"{where}: rosbags cannot read it: {error}") from error


def _last_graph(bag: Bag, topic: str, account: Account) -> Graph:
    last = None
    for data in _messages(bag, topic):
        last = data
    if last is None:
        raise RevisitError(f"{bag.file}: no message on {topic}")
    where = f"{bag.file}: the last message of {topic}"
    return graph_of(_message(bag, last, where).graph, account, where)


def _neighbours(graph: Graph) -> dict[int, list[tuple[int, int]]]:
    """Return the nodes linked with each, and the links' types; of links in both directions one."""
    found: dict[int, set[tuple[int, int]]] = {}
    for one, other, kind in graph.links:
        found.setdefault(one, set()).add((other, kind))
        found.setdefault(other, set()).add((one, kind))
    return {id: sorted(near) for id, near in found.items()}
