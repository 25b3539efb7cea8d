"""The clients of this repository as the robots' way to the server: each of their writes goes through the client's own call for it.

A call returns once the write is acknowledged or refused, however often the client had to send it. `Gone` is a client that gave up.
"""

import json
import re
import subprocess
import threading

from server import Answer, Gone

PATH = re.compile(r"/v1/maps/(?P<map>[^/]+)(?:/(?P<what>[a-z-]+)(?:/(?P<id>[^/]+))?)?$")
# A server that was killed comes back before.
LATEST_S = 300.0
PROBLEM = {"content-type": "application/problem+json"}


class PythonClient:
    """`revisit_slam.Client`, by its typed calls."""

    def __init__(self, url, kills):
        from revisit_slam import Client, Retries

        self.client = Client(url, retries=Retries(total_s=LATEST_S, longest_s=0.2))
        # Number of kills so far: a write that was under way at one may have been sent twice.
        self.kills = kills

    def ask(self, method, path, body=None, headers=(), raw=None, kind=None):
        import msgspec
        from revisit_slam import ProblemError, ServerUnreachable

        kills = self.kills()
        try:
            answer = self.call(method, path, body, dict(headers), raw)
        except ServerUnreachable as error:
            raise Gone(f"{method} {path}: {error!r}") from error
        except ProblemError as error:
            # The first try removed it, and its answer was lost.
            if method == "DELETE" and error.status == 404 and self.kills() > kills:
                return Answer(200, {}, b"{}")
            return Answer(error.status, PROBLEM, msgspec.json.encode(error.problem))
        if raw is not None:
            return Answer(207, {}, b"\n".join(map(msgspec.json.encode, answer)))
        return Answer(204 if answer is None else 200, {}, b"" if answer is None else msgspec.json.encode(answer))

    def call(self, method, path, body, headers, raw):
        name, what, id = PATH.match(path).group("map", "what", "id")
        client = self.client
        if raw is not None:
            return list(client.put_keyframes(name, map(json.loads, raw.splitlines())))
        if method == "PATCH" and what == "anchors":
            return client.patch_anchor(name, id, body, if_match=headers["if-match"])
        calls = {
            ("PUT", None): lambda: client.put_map(name, body),
            ("PATCH", None): lambda: client.patch_map(name, body),
            ("DELETE", None): lambda: client.delete_map(name),
            ("PUT", "keyframes"): lambda: client.put_keyframe(name, id, body),
            ("DELETE", "keyframes"): lambda: client.delete_keyframe(name, id),
            ("POST", "poses"): lambda: client.correct_poses(name, body),
            ("POST", "observations"): lambda: client.change_observations(name, body),
            ("POST", "loops"): lambda: client.confirm_loop(name, body),
            ("DELETE", "loops"): lambda: client.revoke_loop(name, id),
        }
        return calls[method, what]()

    def close(self):
        self.client.close()


class CppClient:
    """The C++ client's `Sender`, in a process of its own (clients/cpp/bench/writer.cpp)."""

    KINDS = {("PUT", "keyframes"): "keyframe", ("DELETE", "keyframes"): "removal", ("POST", "poses"): "poses",
             ("POST", "observations"): "observations", ("POST", "loops"): "confirmation", ("DELETE", "loops"): "revocation"}

    def __init__(self, program, url, name):
        self.process = subprocess.Popen([program, url, name], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.changed, self.outcomes, self.ended = threading.Condition(), {}, False
        self.asked = 0
        threading.Thread(target=self.read, daemon=True).start()

    def read(self):
        for line in self.process.stdout:
            outcome = json.loads(line)
            with self.changed:
                self.outcomes[outcome["kind"], outcome["id"]] = outcome
                self.changed.notify_all()
        with self.changed:
            self.ended = True
            self.changed.notify_all()

    def put(self, kind, id, body):
        try:
            self.process.stdin.write(json.dumps({"kind": kind, "id": id, "body": body}) + "\n")
            self.process.stdin.flush()
        except OSError as error:
            raise Gone(f"{kind} {id}: {error!r}") from error

    def outcome(self, kind, id):
        with self.changed:
            if not self.changed.wait_for(lambda: (kind, id) in self.outcomes or self.ended, LATEST_S) or (kind, id) not in self.outcomes:
                raise Gone(f"no outcome of {kind} {id}")
            return self.outcomes.pop((kind, id))

    def ask(self, method, path, body=None, headers=(), raw=None, kind=None):
        what, id = PATH.match(path).group("what", "id")
        if raw is not None:
            lines = [json.loads(line) for line in raw.splitlines()]
            # At once: they wait behind one another, and share requests.
            for line in lines:
                self.put("keyframe", line["id"], line)
            outcomes = [self.outcome("keyframe", line["id"]) for line in lines]
            return Answer(207, {}, "\n".join(json.dumps({**outcome["answer"], "status": outcome["status"]}) for outcome in outcomes).encode())
        kind = self.KINDS[method, what]
        id = id or body.get("id") or body["session"]
        self.asked += 1
        # Every fourth keyframe brings its question along.
        self.put("asking" if kind == "keyframe" and self.asked % 4 == 0 else kind, id, body)
        outcome = self.outcome(kind, id)
        answer = json.dumps(outcome["answer"]).encode()
        if method == "DELETE" and outcome["status"] == 404 and outcome["answer"] is None:
            # The client knows that its first try removed it.
            return Answer(200, {}, b"{}")
        return Answer(outcome["status"], PROBLEM if outcome["status"] >= 400 else {}, answer)

    def close(self):
        self.process.stdin.close()
        self.process.wait()
