"""`rtabmap_msgs/MapData` in a ROS 2 recording: nodes as they came, with the poses of the last graph."""

from __future__ import annotations

from collections import Counter, OrderedDict
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from ...errors import RevisitError
from ...files import how_to_mend
from ...needed import needed
from ..damage import Account, told_of
from ..limits import MAX_KEYFRAMES, MAX_PIECE_BYTES
from ..observation import Observation
from ..opened import Opened, Wanted
from ..sqlite_file import not_ended
from .chunks import check_chunks
from .definitions import MAP_DATA, typestore
from .links import COVISIBLE, LOOPS, shared_words
from .messages import Graph, graph_of, observation_of

MAX_TOLD = 12
# A message has every node once; those that are not at hand any more share words that are not counted.
NODES_AT_HAND = 1024


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
    with _reading(path) as reader:
        topic = _topic(path, reader, wanted.topic)

    def keyframes() -> Iterator[Observation]:
        with _reading(path) as reader:
            yield from _keyframes(path, reader, topic, wanted, account)

    return Opened("RTAB-Map's MapData", True, keyframes, account)


@contextmanager
def _reading(path: Path) -> Iterator[Any]:
    highlevel = needed("rosbags.highlevel", "rosbags")
    with told_of(path, "rosbags"), highlevel.AnyReader([path], default_typestore=typestore()) as reader:
        yield reader


def _topic(path: Path, reader: Any, named: str | None) -> str:
    """Return the topic of MapData that was named, or the only one."""
    topics = sorted({connection.topic for connection in reader.connections if connection.msgtype == MAP_DATA})
    if named is not None and named not in topics:
        raise RevisitError(f"--topic {named}: {path} has {', '.join(topics) or f'no {MAP_DATA}'}")
    if not topics:
        there = sorted({f"{connection.topic} ({connection.msgtype}, {connection.msgcount})" for connection in reader.connections})
        raise RevisitError(f"{path}: no {MAP_DATA} in it; it has {', '.join(there[:MAX_TOLD]) or 'nothing'}")
    if named is None and len(topics) > 1:
        raise RevisitError(f"{path}: several topics; --topic names one: {', '.join(topics[:MAX_TOLD])}")
    return named or topics[0]


def _messages(reader: Any, topic: str) -> Iterator[bytes]:
    connections = [connection for connection in reader.connections if connection.topic == topic and connection.msgtype == MAP_DATA]
    for _, _, data in reader.messages(connections):
        if len(data) > MAX_PIECE_BYTES:
            raise RevisitError(f"{topic}: a message of {len(data)} bytes; at most {MAX_PIECE_BYTES >> 20} MiB are taken")
        yield data


def _keyframes(path: Path, reader: Any, topic: str, wanted: Wanted, account: Account) -> Iterator[Observation]:
    name = wanted.name(path)
    final = _last_graph(path, reader, topic, account)
    neighbours = _neighbours(final)
    # None for a node that was left out.
    names: dict[int, str | None] = {}
    words: OrderedDict[int, Counter[int]] = OrderedDict()
    left_graph = 0
    for number, data in enumerate(_messages(reader, topic), 1):
        with account.part(f"message {number} of {topic}") as whole:
            message = _message(reader, data, whole)
            graph: Graph | None = None
            for node in message.nodes:
                id = int(node.id)
                if id in names:
                    continue
                if len(names) >= MAX_KEYFRAMES:
                    raise RevisitError(f"{path}: it has more than {MAX_KEYFRAMES} nodes; so many are not taken")
                names[id] = None
                with account.part(f"node {id}") as where:
                    if id in final.poses:
                        here, near = final, neighbours.get(id, [])
                    else:
                        # A node that left the graph stands where the graph had it when it came.
                        graph = graph or graph_of(message.graph, account, whole)
                        here, near = graph, _neighbours(graph).get(id, [])
                    seen = observation_of(node, here, name, where)
                    if seen is None:
                        raise RevisitError(f"{where}: without a pose, or between keyframes")
                    left_graph += here is not final
                    for other, kind in near:
                        earlier = names.get(other) if other != id else None
                        if earlier is not None and kind in LOOPS:
                            seen.loops.append(earlier)
                        elif earlier is not None and kind in COVISIBLE:
                            seen.covisible[earlier] = shared_words(seen.words, words.get(other))
                    names[id] = seen.id
                    words[id] = seen.words or Counter()
                    if len(words) > NODES_AT_HAND:
                        words.popitem(last=False)
                    yield seen
    if left_graph:
        are = "node is" if left_graph == 1 else "nodes are"
        account.notes.append(f"{left_graph} {are} not in the last graph: they stand where they stood when they came")


def _message(reader: Any, data: bytes, where: str) -> Any:
    try:
        return reader.deserialize(data, MAP_DATA)
    except Exception as error:  # noqa: BLE001 - it raises types of its own
        raise RevisitError(f"{where}: rosbags cannot read it: {error}") from error


def _last_graph(path: Path, reader: Any, topic: str, account: Account) -> Graph:
    last = None
    for data in _messages(reader, topic):
        last = data
    if last is None:
        raise RevisitError(f"{path}: no message on {topic}")
    where = f"{path}: the last message of {topic}"
    return graph_of(_message(reader, last, where).graph, account, where)


def _neighbours(graph: Graph) -> dict[int, list[tuple[int, int]]]:
    """Return the nodes linked with each, and the links' types; of links in both directions one."""
    found: dict[int, set[tuple[int, int]]] = {}
    for one, other, kind in graph.links:
        found.setdefault(one, set()).add((other, kind))
        found.setdefault(other, set()).add((one, kind))
    return {id: sorted(near) for id, near in found.items()}
