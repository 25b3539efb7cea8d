"""What one request costs the server in CPU, and the ground on which it is asked."""

import base64
import contextlib
import http.client
import itertools
import json
import socket
import struct
import time
from pathlib import Path
from typing import NamedTuple

from server import expect, until

# The server is at rest once, in so many looks one after another, it used less than this share of a core and no thread of it
# was running, waiting for a core or for the disk.
REST_SHARE, REST_LOOKS, LOOK_S = 0.06, 2, 0.012
REST_MOST_S = 300
# An answer that takes longer is a fault.
ANSWER_MOST_S, BUILT_MOST_S = 120, 900
# How long a stream of events must say nothing until it is closed.
STREAM_ENDS_S = 0.3
LINES_AT_ONCE = 2_000


class Ask(NamedTuple):
    """One request. The answer to a stream is read as long as something comes; a job's request costs what its job does."""

    method: str
    path: str
    raw: bytes | None = None
    kind: str = "application/json"
    statuses: tuple = (200, 201, 202, 204)
    headers: tuple = ()
    stream: bool = False
    job: bool = False

    def send(self, client):
        if not self.stream:
            return expect(client.ask(self.method, self.path, headers=self.headers, raw=self.raw, kind=self.kind), *self.statuses)
        host, port = client.address.rsplit(":", 1)
        with contextlib.closing(http.client.HTTPConnection(host, int(port), timeout=STREAM_ENDS_S)) as connection:
            connection.request(self.method, self.path, headers=dict(self.headers))
            answer = connection.getresponse()
            with contextlib.suppress(socket.timeout):
                while answer.read1(1 << 20):
                    pass
            return expect(answer, *self.statuses)


def ask(method, path, body=None, **more):
    return Ask(method, path, None if body is None else json.dumps(body).encode(), **more)


def encoded(data):
    return base64.b64encode(data).decode()


def packed(numbers, kind):
    """A column of numbers as one text."""
    return encoded(struct.pack(f"<{len(numbers)}{kind}", *numbers))


class Ground:
    """A server, on which cases build their maps and which is asked what they ask."""

    def __init__(self, server):
        self.server, self.client, self.asking = server, server.client(BUILT_MOST_S), server.client(ANSWER_MOST_S)
        # The clock of another process's CPU, which counts its threads that have ended, too.
        self.clock = (~server.process.pid << 3) | 2
        self.numbers, self.kept, self.headers, self.salt = itertools.count(), {}, (), 0
        self.idle = 0.0

    def cpu(self):
        return time.clock_gettime(self.clock)

    def busy(self):
        """Whether a thread runs, or would if it could."""
        for stat in Path(f"/proc/{self.server.process.pid}/task").glob("*/stat"):
            with contextlib.suppress(OSError):
                if stat.read_text().rsplit(")", 1)[1].split()[0] in "RD":
                    return True
        return False

    def rest(self):
        """Waits until nothing runs any more; the CPU used so far."""
        ended, quiet = time.monotonic() + REST_MOST_S, 0
        before, at = self.cpu(), time.monotonic()
        while quiet < REST_LOOKS:
            if at > ended:
                raise AssertionError(f"the server did not come to rest in {REST_MOST_S} s")
            time.sleep(LOOK_S)
            now, then = self.cpu(), time.monotonic()
            quiet = quiet + 1 if now - before < REST_SHARE * (then - at) and not self.busy() else 0
            before, at = now, then
        return before

    def learn_idle(self, seconds):
        """What the server uses by itself, as a share of a core."""
        before = self.rest()
        time.sleep(seconds)
        self.idle = (self.cpu() - before) / seconds

    def cost(self, request):
        """CPU seconds of one request, with all that it leaves to be done behind."""
        before, began = self.rest(), time.monotonic()
        answer = request.send(self.asking)
        if request.job:
            path = f"{request.path}/{answer.json()['id']}"
            until(lambda: self.do("GET", path)["state"] == "done", REST_MOST_S, f"the end of {path}")
        used = self.rest() - before
        return max(0.0, used - self.idle * (time.monotonic() - began))

    def do(self, method, path, body=None, **more):
        """Sends what is not measured; the answer's body."""
        answer = ask(method, path, body, headers=self.headers, **more).send(self.client)
        return answer.json() if answer.body[:1] in (b"{", b"[") else None

    def administer(self):
        """Makes the first key: from now on every request needs one."""
        if not self.headers:
            self.headers = self.key()

    def key(self):
        """The headers of a new key that may do anything."""
        made = self.do("POST", "/v1/keys", {"actions": ["read", "write", "query", "admin"]}, statuses=(201,))
        return (("authorization", f"Bearer {made['secret']}"),)

    def map(self, lines=(), body=None, name=None):
        """A new map with these keyframes; its path."""
        path = f"/v1/maps/{name or f'm-{next(self.numbers)}'}"
        self.do("PUT", path, body or {})
        self.add(path, lines)
        return path

    def add(self, path, lines):
        """Uploads keyframes in bulk, each of which must be taken."""
        lines = iter(lines)
        while part := list(itertools.islice(lines, LINES_AT_ONCE)):
            raw = b"\n".join(json.dumps(line).encode() for line in part)
            Ask("POST", f"{path}/keyframes", raw, "application/x-ndjson", (200,), self.headers).send(self.client)

    def once(self, key, build):
        """A map that several cases may use, for they hardly change it. Those that run at once have one each."""
        key = (key, self.salt)
        if key not in self.kept:
            self.kept[key] = build()
        return self.kept[key]
