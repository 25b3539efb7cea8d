"""`rtabmap_msgs/MapData` in a ROS 2 recording: nodes as they came, with the poses of the last graph."""

from __future__ import annotations

from collections import Counter, OrderedDict
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from ...errors import RevisitError
from ...needed import needed
from ..damage import told_of
from ..limits import MAX_KEYFRAMES, MAX_PIECE_BYTES
from ..observation import Observation
from ..opened import Opened, Wanted
from .chunks import check_chunks
from .definitions import MAP_DATA, typestore
from .links import COVISIBLE, LOOPS, shared_words
from .messages import Graph, graph_of, observation_of

MAX_TOLD = 12
# A message has every node once; those that are not at hand any more share words that are not counted.
NODES_AT_HAND = 1024


def open_map_data(path: Path, wanted: Wanted) -> Opened:
    """Open a recording."""
    notes: list[str] = []
    with told_of(path, "the reader of MCAP"):
        for part in sorted(path.glob("*.mcap")) if path.is_dir() else [path]:
            check_chunks(part)
    with _reading(path) as reader:
        topic = _topic(path, reader, wanted.topic)

    def keyframes() -> Iterator[Observation]:
        with _reading(path) as reader:
            yield from _keyframes(path, reader, topic, wanted, notes)

    return Opened("RTAB-Map's MapData", True, keyframes, notes)


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


def _keyframes(path: Path, reader: Any, topic: str, wanted: Wanted, notes: list[str]) -> Iterator[Observation]:
    name = wanted.name(path)
    final = _last_graph(path, reader, topic)
    neighbours = _neighbours(final)
    names: dict[int, str] = {}
    words: OrderedDict[int, Counter[int]] = OrderedDict()
    left_out, left_graph = 0, 0
    for number, data in enumerate(_messages(reader, topic), 1):
        message = reader.deserialize(data, MAP_DATA)
        where = f"{path}: message {number} of {topic}"
        graph: Graph | None = None
        for node in message.nodes:
            id = int(node.id)
            if id in names:
                continue
            if len(names) >= MAX_KEYFRAMES:
                raise RevisitError(f"{path}: it has more than {MAX_KEYFRAMES} nodes; so many are not taken")
            if id in final.poses:
                here, near = final, neighbours.get(id, [])
            else:
                # A node that left the graph stands where the graph had it when it came.
                graph = graph or graph_of(message.graph, where)
                here, near = graph, _neighbours(graph).get(id, [])
            seen = observation_of(node, here, name, where)
            if seen is None:
                left_out += 1
                continue
            left_graph += here is not final
            for other, kind in near:
                if other not in names:
                    continue
                if kind in LOOPS:
                    seen.loops.append(names[other])
                elif kind in COVISIBLE:
                    seen.covisible[names[other]] = shared_words(seen.words, words.get(other))
            names[id] = seen.id
            words[id] = seen.words or Counter()
            if len(words) > NODES_AT_HAND:
                words.popitem(last=False)
            yield seen
    if left_graph:
        notes.append(f"{_nodes(left_graph)} not in the last graph: they stand where they stood when they came")
    if left_out:
        notes.append(f"{_nodes(left_out)} left out, without a pose or between keyframes")


def _last_graph(path: Path, reader: Any, topic: str) -> Graph:
    last = None
    for data in _messages(reader, topic):
        last = data
    if last is None:
        raise RevisitError(f"{path}: no message on {topic}")
    return graph_of(reader.deserialize(last, MAP_DATA).graph, f"{path}: the last message of {topic}")


def _neighbours(graph: Graph) -> dict[int, list[tuple[int, int]]]:
    """Return the nodes linked with each, and the links' types; of links in both directions one."""
    found: dict[int, set[tuple[int, int]]] = {}
    for one, other, kind in graph.links:
        found.setdefault(one, set()).add((other, kind))
        found.setdefault(other, set()).add((one, kind))
    return {id: sorted(near) for id, near in found.items()}


def _nodes(count: int) -> str:
    return f"{count} node is" if count == 1 else f"{count} nodes are"
