"""Writers and readers of keyframes in several maps, each request through a random server, and what they saw.

A writer sends each keyframe until it is acknowledged. What they note is a history that `linearizable.py` judges.
"""

import collections
import json
import random
import threading
import time

from linearizable import CREATED, Read, Stored, Write
from robots import same
from server import Client, Gone

# Keyframes of a map that are compared also as answered from memory.
ASKED_AGAIN = 50
# Longest time for which an answer at the end may be 503.
MAX_503_S = 30


def keyframe(name):
    """Returns the content of a keyframe, which its id determines."""
    draw = random.Random(name)
    words = sorted(draw.sample(range(100_000), 20))
    at = {axis: draw.randrange(-4000, 4000) / 8 for axis in "xyz"}
    return {
        "session": name.split(":")[0],
        "stamp": {"sec": draw.randrange(10**6), "nanosec": draw.randrange(10**9)},
        "pose": {"translation": at, "rotation": {"x": 0.5, "y": 0.5, "z": 0.5, "w": 0.5}},
        "bow": {"words": words, "weights": [0.05] * len(words)},
        "detections": [{"class": "door_number", "confidence": 0.875, "box": [10.0, 10.0, 50.5, 30.0],
                        "position": [at["x"], at["y"], at["z"] + 2.0], "text": f"{draw.randrange(10**6)}"}],
    }


class Traffic:
    """What the writers and readers did, and saw."""

    def __init__(self, addresses, maps):
        self.addresses, self.maps = addresses, maps
        self.lock = threading.Lock()
        self.writes, self.reads = [], []
        self.refused, self.broken, self.forwarded, self.answered = 0, 0, 0, 0
        self.unexpected = collections.Counter()
        # By address: requests sent there.
        self.asked = collections.Counter()
        # When the newest acknowledged attempt at each map was sent.
        self.newest = dict.fromkeys(maps, 0.0)
        # The newest version of each map that anybody was told of, and answers that were older than asked for, or torn.
        self.told = dict.fromkeys(maps, CREATED)
        self.followed, self.stale = 0, []
        # What ended a thread of ours.
        self.crashes = []
        threading.excepthook = lambda crash: self.crashes.append(f"{crash.thread.name}: {crash.exc_value!r}")
        self.reading, self.writing = threading.Event(), threading.Event()
        self.reading.set()
        self.writing.set()

    def ask(self, clients, method, path, body=None, headers=()):
        """Returns the answer of a random server; None if it did not answer, or refused for the moment."""
        client = random.choice(clients)
        with self.lock:
            self.asked[client.address] += 1
        try:
            answer = client.ask(method, path, body, headers)
        except Gone:
            with self.lock:
                self.broken += 1
            return None
        owner = answer.headers.get("x-revisit-owner")
        with self.lock:
            self.answered += 1
            self.forwarded += owner not in (None, f"http://{client.address}")
            if answer.status == 412 and headers or answer.status == 503 and answer.headers.get("retry-after"):
                self.refused += 1
                return None
            if answer.status not in (200, 201):
                self.unexpected[f"{method} {path.split('/')[-2]}: {answer}"] += 1
                return None
        return answer

    def clients(self, timeout):
        return [Client(address, timeout) for address in self.addresses]


class Writer(threading.Thread):
    """Sends keyframes. One that is not acknowledged is sent again later, until it is; meanwhile other maps have their turn."""

    def __init__(self, traffic, number, pause, timeout):
        super().__init__(daemon=True)
        self.traffic, self.number, self.pause, self.timeout = traffic, number, pause, timeout
        self.pending, self.sent = {}, 0

    def run(self):
        traffic, clients = self.traffic, self.traffic.clients(self.timeout)
        while traffic.writing.is_set() or self.pending:
            name = random.choice(traffic.maps if traffic.writing.is_set() else list(self.pending))
            write = self.pending.get(name) or self.begin(name)
            attempt = time.monotonic()
            answer = traffic.ask(clients, "PUT", f"/v1/maps/{name}/keyframes/{write.id}", keyframe(write.id))
            if answer is not None:
                self.acknowledged(write, attempt, answer)
            time.sleep(random.uniform(0.02, 2 * self.pause))

    def begin(self, name):
        write = Write(name, f"w-{self.number}:{self.sent}", time.monotonic())
        self.sent += 1
        self.pending[name] = write
        with self.traffic.lock:
            self.traffic.writes.append(write)
        return write

    def acknowledged(self, write, attempt, answer):
        write.acknowledged, write.attempt = time.monotonic(), attempt
        version = answer.json()["map_version"]
        if answer.status == 201:
            write.version = version
        else:
            write.replayed = version
        del self.pending[write.map]
        with self.traffic.lock:
            self.traffic.told[write.map] = max(version, self.traffic.told[write.map])
            self.traffic.newest[write.map] = max(attempt, self.traffic.newest[write.map])


class Reader(threading.Thread):
    """Reads the version and the count of random maps."""

    def __init__(self, traffic, pause, timeout):
        super().__init__(daemon=True)
        self.traffic, self.pause, self.timeout = traffic, pause, timeout

    def run(self):
        traffic, clients = self.traffic, self.traffic.clients(self.timeout)
        while traffic.reading.is_set():
            name, began = random.choice(traffic.maps), time.monotonic()
            answer = traffic.ask(clients, "GET", f"/v1/maps/{name}")
            if answer is not None:
                ended, body = time.monotonic(), answer.json()
                with traffic.lock:
                    traffic.reads.append(Read(name, began, ended, body["map_version"], body["keyframes"]))
            time.sleep(random.uniform(0.02, 2 * self.pause))


class Follower(Reader):
    """Reads maps with the newest version that anybody was told of: an answer, also one from a copy, is not older."""

    def run(self):
        traffic, clients = self.traffic, self.traffic.clients(self.timeout)
        while traffic.reading.is_set():
            name = random.choice(traffic.maps)
            with traffic.lock:
                told = traffic.told[name]
            answer = traffic.ask(clients, "GET", f"/v1/maps/{name}", None, {"x-revisit-min-version": str(told)})
            if answer is not None:
                body = answer.json()
                with traffic.lock:
                    traffic.followed += 1
                    traffic.told[name] = max(body["map_version"], traffic.told[name])
                    if body["map_version"] < told or body["keyframes"] != body["map_version"] - CREATED:
                        traffic.stale.append(f"{name}: asked for version {told}, answered {answer}")
            time.sleep(random.uniform(0.02, 2 * self.pause))


def finish(traffic, writers, readers, seconds):
    """Ends the writers once no write is in doubt, and then the readers. Returns the writes that were not acknowledged in time."""
    traffic.writing.clear()
    end = time.monotonic() + seconds
    for writer in writers:
        writer.join(max(0, end - time.monotonic()))
    left = [write for writer in writers for write in list(writer.pending.values())]
    traffic.reading.clear()
    for reader in readers:
        reader.join(2 * reader.timeout)
    return left


def stored(ask, traffic):
    """Returns the maps as the database has them (`ask` returns the rows of a statement), compared with what the servers answer."""
    kept = {name: Stored(int(version)) for name, version in ask("select id, version from maps where deleted = 0")}
    for name, each, version in ask("select m.id, k.id, k.version from keyframes k join maps m using (map_key)"):
        kept[name].keyframes[each] = int(version)
    clients = traffic.clients(600)
    for name in traffic.maps:
        kept[name].other = not_as_exported(clients, name, kept[name]) | not_as_answered(clients, name, kept[name])
    for client in clients:
        client.close()
    return kept


def not_as_exported(clients, name, kept):
    answer = ask_until_served(clients, f"/v1/maps/{name}/export")
    if answer.status != 200:
        return dict.fromkeys(kept.keyframes, f"the export is {answer}")
    exported = [json.loads(line) for line in answer.body.splitlines() if line]
    bodies = {line["id"]: line["body"] for line in exported if line["op"] == "keyframe"}
    return {each: f"exported is {bodies.get(each)}" for each in kept.keyframes if not same(keyframe(each), bodies.get(each))}


def not_as_answered(clients, name, kept):
    other = {}
    for each in random.sample(sorted(kept.keyframes), min(ASKED_AGAIN, len(kept.keyframes))):
        answer = ask_until_served(clients, f"/v1/maps/{name}/keyframes/{each}")
        if answer.status != 200 or not same(keyframe(each), answer.json()):
            other[each] = f"answered is {answer}"
    return other


def ask_until_served(clients, path):
    """Asks random servers until one does not refuse for the moment: after the last fault maps still move."""
    end = time.monotonic() + MAX_503_S
    while True:
        client = random.choice(clients)
        answer = client.ask("GET", path)
        if answer.status != 503 or not answer.headers.get("retry-after") or time.monotonic() > end:
            return answer
        print(f"  asked at the end: {path} at {client.address} is {answer}", flush=True)
        time.sleep(0.2)
