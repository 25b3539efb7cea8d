"""What the server answers about a map: everything that can be read of it, and what of it must stay as it was."""

import collections
import contextlib
import json
import socket

from server import expect


def pages(round, path):
    """The pages of a list, as they are answered."""
    cursor = ""
    while cursor is not None:
        answer = round.ask("GET", f"{path}{'&' if '?' in path else '?'}limit=1000{cursor}")
        yield answer
        following = answer.status == 200 and answer.json().get("next_cursor")
        cursor = f"&cursor={following}" if following else None


def items(round, path, field):
    """What the items of a list have in this field."""
    return [item[field] for page in pages(round, path) for item in expect(page, 200).json()["items"]]


def answers(round, of):
    """(path, bytes) of everything that can be read of a map."""
    host, port = round.server.address.rsplit(":", 1)
    with socket.create_connection((host, int(port)), timeout=60) as stream:
        # What the stream tells from its beginning comes while others are read.
        stream.sendall(f"GET {of.path}/events?since=0 HTTP/1.1\r\nhost: {host}:{port}\r\n\r\n".encode())
        yield from answers_at_once(round, of)
        told = stream.recv(1 << 16)
        stream.settimeout(0.05)
        with contextlib.suppress(socket.timeout):
            while part := stream.recv(1 << 20):
                told += part
        yield f"{of.path}/events", told


def answers_at_once(round, of):
    base = of.path
    releases = items(round, f"{base}/releases", "name")
    several = [f"keyframes/{name}{part}" for name in items(round, f"{base}/keyframes", "id") for part in ("", "/covisible", "/local-anchor-map")]
    several += [f"anchors/{name}{part}" for name in items(round, f"{base}/anchors?merged=true", "id") for part in ("", "/transcript", "/crop")]
    several += [f"loop-queries/{name}" for name in items(round, f"{base}/loop-queries", "query")]
    several += [path for name in releases for path in (f"releases/{name}", f"changes?since={name}&limit=1000", f"export?release={name}")]
    several += [f"erase/e-{number}" for number in range(1, 6)] + [f"judgements/j-{number}" for number in range(1, round.names + 1)]
    several += ["frames", "trajectory", "trajectory?format=kitti", "trajectory?format=g2o", "export"]
    lists = ("sessions", "keyframes", "anchors?merged=true", "loops", "loop-queries", "releases")
    for path in ("/v1/maps", "/v1/backups", *(f"{base}/{name}" for name in lists)):
        for page in pages(round, path):
            yield path, page.body
    for path in several:
        answer = round.ask("GET", f"{base}/{path}")
        # That something is not there says its name.
        if answer.status == 200:
            yield f"{base}/{path.split('/')[0].split('?')[0]}", answer.body
    for path in (base, f"{base}?detail=brief", "/v1/usage", "/metrics", "/healthz", "/readyz"):
        yield path.split("?")[0], round.ask("GET", path).body


def search_answers(round, hunt, of):
    """What the answers about a map have, those of one kind together."""
    told = collections.defaultdict(list)
    for path, body in answers(round, of):
        told[path].append(body)
    return [find for path, bodies in told.items() for find in hunt.search(f"answer {path}", b"\n".join(bodies))]


def stays(round, of):
    """What was sent by those that stay, as it is answered. What a keyframe is covisible with, and its anchors, follow from others too."""
    held = {}
    for name, robot in of.keyframes.items():
        if robot.doomed:
            continue
        body = expect(round.ask("GET", f"{of.path}/keyframes/{name}"), 200).json()
        for field in ("map_version", "covisible", "covisible_total"):
            body.pop(field, None)
        for detection in body["detections"]:
            for field in ("anchor", "outcome", "reason", "state"):
                detection.pop(field, None)
        # A point that nobody observes any more is gone.
        points, observed = body["map_points"], set(body["observes"])
        body["map_points"] = [pair for pair in zip(points["ids"], points["positions"]) if pair[0] in observed]
        held[name] = json.dumps(body, sort_keys=True)
    return held


def counted(round, of):
    """How many keyframes each release has."""
    exports = {name: expect(round.ask("GET", f"{of.path}/export?release={name}"), 200).body.splitlines() for name in of.releases}
    return {name: len({json.loads(line)["id"] for line in lines if b'"op":"keyframe"' in line}) for name, lines in exports.items()}
