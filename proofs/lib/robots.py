"""Robots that write, and remember what they sent, when, and whether it was acknowledged.

A robot's history is the model: for each key (a keyframe, a loop, an anchor, a map) the states it was given, each
with the moment it was sent and the moment it was acknowledged. At any later moment a key may have the state of its last
acknowledged write, or of one sent after that and not acknowledged: nothing else. A write of several keys is whole or absent.
"""

import base64
import json
import random
import threading
import time

from server import Gone, fail

POINTS, STEP = 30, 10
LARGEST_POINT = 2**63 - 1
ABSENT = None
# What a robot writes, each as often as it is listed.
KINDS = ["put"] * 6 + ["bulk", "cull", "poses", "poses", "loop", "loop", "revoke", "anchor", "anchor", "map_put", "map_patch", "map_delete"]


class Write:
    """One request: what it would make of which keys."""

    __slots__ = ("what", "states", "sent", "acknowledged", "status", "answer")

    def __init__(self, what, states, sent):
        self.what, self.states, self.sent = what, states, sent
        self.acknowledged, self.status, self.answer = None, None, None


def pose(x, y=0.25):
    return {"translation": {"x": x, "y": y, "z": -1.5}, "rotation": {"x": 0.5, "y": 0.5, "z": 0.5, "w": 0.5}}


def keyframe(robot, number, ballast=0):
    """A robot that walks along a corridor of numbered doors; every number is exact in binary. Lists come in any order,
    with gaps and repeats, and every other robot counts its points from the far end of what an id may be."""
    x, base, chance = number * 0.5, number * STEP, random.Random(f"{robot} {number}")
    seen = range(base, base + POINTS)
    far = sum(robot.encode()) % 2 == 1
    name = {i: LARGEST_POINT - 7 * i if far else i for i in seen}
    observed = list(seen)
    chance.shuffle(observed)
    # The words are a set, too.
    words = [(number * 2, 0.5), (number * 2 + 1, 0.25), (500000, 0.25), (4294967295, -0.0)]
    chance.shuffle(words)
    body = {
        "session": robot, "stamp": {"sec": 1000 + number, "nanosec": 500}, "pose": pose(x),
        "camera": {"fx": 525.0, "fy": 525.5, "cx": 320.0, "cy": 240.0, "width": 640, "height": 480},
        "bow": {"words": [word for word, _ in words], "weights": [weight for _, weight in words]},
        "map_points": {"ids": [name[i] for i in observed], "positions": [[i * 0.0625, -0.0, 2.0] for i in observed]},
        "observes": [name[i] for i in observed + chance.choices(observed, k=number % 4)],
    }
    if number % 3 == 0:
        body["detections"] = [{"class": "door_number", "confidence": 0.875, "box": [100.0, 120.0, 180.0, 160.5],
                               "position": [x + 1.0, 0.5, 2.0], "text": f"{robot}-{900 + number}"},
                              {"class": "Türschild", "confidence": 5e-324, "box": [-1e6, -0.0, 1e6, 5e-324],
                               "map_points": [name[i] for i in chance.choices(observed, k=6)], "text": f"出口 {number} \"\u2028"}]
    if ballast:
        count = max(1, ballast // 512)
        descriptors = random.Random(f"{robot} {number}").randbytes(count * 512)
        body["features"] = {"descriptor_bytes": 512, "descriptors": base64.b64encode(descriptors).decode(),
                            "keypoints": [[i % 640, i % 480, 0] for i in range(count)], "map_points": [-1] * count}
    return body


def canonical(body):
    """A keyframe as it is answered: sets ascending, each member once, and words that weigh nothing left out."""
    points, bow = body["map_points"], body["bow"]
    words = sorted((word, weight) for word, weight in zip(bow["words"], bow["weights"]) if weight)
    placed = sorted(zip(points["ids"], points["positions"]))
    kept = body | {"observes": sorted(set(body["observes"])),
                   "bow": {"words": [word for word, _ in words], "weights": [weight for _, weight in words]},
                   "map_points": {"ids": [i for i, _ in placed], "positions": [at for _, at in placed]}}
    if "detections" in body:
        seen = lambda detection: {"map_points": sorted(set(detection["map_points"]))} if "map_points" in detection else {}
        kept["detections"] = [detection | seen(detection) for detection in body["detections"]]
    return kept


class Robot(threading.Thread):
    """Writes until the server is gone or it is told to stop."""

    def __init__(self, server, name, shared, clock=time.monotonic, seed=0, kinds=None, turns=None, patience=0.0):
        super().__init__(name=name, daemon=True)
        self.client = server.client()
        self.robot, self.shared, self.clock = name, shared, clock
        self.chance = random.Random(f"{name} {seed}")
        self.history, self.versions, self.refusals = [], {}, {}
        self.number, self.turns, self.frozen = 0, turns, set()
        self.stopping, self.trouble, self.acks = threading.Event(), None, 0
        self.latencies, self.patience = [], patience
        self.kinds = kinds or KINDS

    # What a key is now, as far as acknowledged.
    def alive(self, kind):
        now = {}
        for write in self.history:
            for key, state in write.states.items():
                if key[0] == kind:
                    now[key] = state if write.acknowledged else "doubt"
        return [key for key, state in now.items() if state is not ABSENT and state != "doubt" and key not in self.frozen]

    def any(self, kind):
        """One of these keys, if there is any."""
        mine = self.alive(kind)
        return self.chance.choice(mine) if mine else None

    def run(self):
        try:
            turn = 0
            while not self.stopping.is_set() and (self.turns is None or turn < self.turns):
                getattr(self, self.chance.choice(self.kinds))()
                turn += 1
        except Gone:
            pass
        except Exception as error:  # told by whoever joins this thread
            self.trouble = error
        finally:
            self.client.close()

    def send(self, what, states, method, path, body=None, expect=(200, 201), headers=(), raw=None):
        write = Write(what, states, self.clock())
        self.history.append(write)
        began = time.monotonic()
        kind = "application/x-ndjson" if raw is not None else "application/json"
        answer = self.client.ask(method, path, body, headers, raw, kind)
        self.latencies.append(time.monotonic() - began)
        write.status, write.answer = answer.status, answer
        if answer.status in expect:
            write.acknowledged = self.clock()
            self.acks += 1
            if raw is None:
                self.saw_version(path, answer)
        elif answer.status == 207 and what == "bulk":
            pass
        elif answer.status in (429, 500, 503, 507):
            self.refusals[answer.status] = self.refusals.get(answer.status, 0) + 1
            if "application/problem+json" not in answer.headers.get("content-type", "") or answer.json()["status"] != answer.status:
                raise AssertionError(f"{method} {path}: {answer} is no problem document")
            # It may be there, whole, or not: nobody builds on it.
            self.frozen.update(states)
            time.sleep(self.patience)
        else:
            raise AssertionError(f"{self.robot}: {method} {path}: {answer}")
        return write

    def saw_version(self, path, answer):
        if path.count("/") >= 3 and answer.body[:1] == b"{":
            version = answer.json().get("map_version")
            name = path.split("/")[3].split("?")[0]
            if version is not None:
                self.versions[name] = max(version, self.versions.get(name, 0))

    def put(self):
        body, number = keyframe(self.robot, self.number), self.number
        self.number += 1
        name = f"{self.robot}:{number}"
        write = self.send("put", {("keyframe", self.shared, name): canonical(body)}, "PUT",
                          f"/v1/maps/{self.shared}/keyframes/{name}", body)
        if write.acknowledged and "detections" in body:
            anchor = write.answer.json()["detections"][0].get("anchor")
            if anchor:
                # Its description by hand is a key of its own from here on.
                write.states[("anchor", self.shared, anchor)] = f"{self.robot}-{900 + number}"
        write.answer = None

    def bulk(self):
        numbers = range(self.number, self.number + 5)
        self.number += 5
        lines, writes = [], []
        for number in numbers:
            name, body = f"{self.robot}:{number}", keyframe(self.robot, number)
            lines.append(json.dumps({"id": name, **body}))
            writes.append(Write("line", {("keyframe", self.shared, name): canonical(body)}, self.clock()))
        # Each line is a write for itself.
        self.history += writes
        write = self.send("bulk", {}, "POST", f"/v1/maps/{self.shared}/keyframes", raw="\n".join(lines).encode())
        self.acks -= 1 if write.acknowledged else 0
        if write.status in (200, 207):
            for line, part in zip(write.answer.body.splitlines(), writes):
                line = json.loads(line)
                # 200: sent again by a client that had no answer.
                if line["status"] in (200, 201):
                    part.acknowledged = self.clock()
                    self.acks += 1
                    self.versions[self.shared] = max(line["map_version"], self.versions.get(self.shared, 0))
                else:
                    if line["status"] not in (429, 500, 503, 507):
                        raise AssertionError(f"bulk: {line}")
                    self.refusals[line["status"]] = self.refusals.get(line["status"], 0) + 1
                    self.frozen.update(part.states)
        else:
            for part in writes:
                self.frozen.update(part.states)
        write.answer = None

    def cull(self):
        # Those without detections: an anchor that lost its keyframe is another story.
        mine = [key for key in self.alive("keyframe") if int(key[2].split(":")[1]) % 3]
        if not mine:
            return self.put()
        key = self.chance.choice(mine)
        self.send("cull", {key: ABSENT}, "DELETE", f"/v1/maps/{key[1]}/keyframes/{key[2]}")

    def poses(self):
        mine = self.alive("keyframe")[-6:]
        if len(mine) < 2:
            return self.put()
        now = self.now()
        up = self.chance.randrange(1, 4096) / 64
        states = {key: now[key] | {"pose": pose(int(key[2].split(":")[1]) * 0.5, up)} for key in mine}
        body = {"session": self.robot, "keyframes": {"ids": [key[2] for key in mine], "poses": [states[key]["pose"] for key in mine]}}
        # A detection's position moves with its keyframe: it is not compared afterwards.
        for state in states.values():
            state.pop("detections", None)
        self.send("poses", states, "POST", f"/v1/maps/{self.shared}/poses", body)

    def loop(self):
        mine = self.alive("keyframe")
        if len(mine) < 2:
            return self.put()
        here, there = self.chance.sample(mine, 2)
        name = f"{self.robot}:loop-{len(self.history)}"
        body = {"id": name, "keyframe": here[2], "candidate": there[2]}
        self.send("loop", {("loop", self.shared, name): True}, "POST", f"/v1/maps/{self.shared}/loops", body)

    def revoke(self):
        key = self.any("loop")
        if key is None:
            return self.loop()
        self.send("revoke", {key: ABSENT}, "DELETE", f"/v1/maps/{key[1]}/loops/{key[2]}")

    def anchor(self):
        key = self.any("anchor")
        if key is None:
            return self.put()
        text = f"by hand {self.chance.randrange(10**9)}"
        self.send("anchor", {key: text}, "PATCH", f"/v1/maps/{key[1]}/anchors/{key[2]}", {"description": text},
                  headers={"if-match": "*"})

    def map_put(self):
        name = f"own-{self.shared}-{self.robot}-{len(self.history)}"
        text = f"made {len(self.history)}"
        self.send("map", {("map", name): text}, "PUT", f"/v1/maps/{name}", {"description": text})

    def map_patch(self):
        key = self.any("map")
        if key is None:
            return self.map_put()
        text = f"changed {self.chance.randrange(10**9)}"
        self.send("map", {key: text}, "PATCH", f"/v1/maps/{key[1]}", {"description": text})

    def map_delete(self):
        mine = self.alive("map")
        if len(mine) < 2:
            return self.map_put()
        key = self.chance.choice(mine)
        self.send("map", {key: ABSENT}, "DELETE", f"/v1/maps/{key[1]}", expect=(200, 204))
        self.versions.pop(key[1], None)

    def now(self):
        states = {}
        for write in self.history:
            if write.acknowledged:
                states.update(write.states)
        return states


def finish(robots, seconds=None):
    """Waits until the robots have ended, and fails if one of them met trouble."""
    for robot in robots:
        robot.join(seconds)
        if robot.is_alive():
            fail(f"{robot.robot} waits for an answer that does not come")
        if robot.trouble:
            fail(f"{robot.robot}: {robot.trouble}")


def same(sent, kept):
    """The same numbers, however they are written; fields that the server adds are its own."""
    if isinstance(sent, dict):
        return isinstance(kept, dict) and all(name in kept and same(value, kept[name]) for name, value in sent.items())
    if isinstance(sent, list):
        return isinstance(kept, list) and len(sent) == len(kept) and all(map(same, sent, kept))
    if isinstance(sent, int) and isinstance(kept, int):
        # Numbers of points are large, and near one another.
        return sent == kept
    if isinstance(sent, float | int) and not isinstance(sent, bool):
        return isinstance(kept, float | int) and abs(sent - kept) <= 1e-6 * max(1.0, abs(sent))
    return sent == kept


class Audit:
    """Holds the robots' histories against a server, as they may be at a moment (None: now)."""

    def __init__(self, server, robots, moment=None, settle=True):
        self.client = server.client()
        self.loops = {}
        self.lost, self.checked, self.found, self.absent, self.wrong = [], 0, 0, 0, []
        for robot in robots:
            self.check(robot, moment, settle)

    def kept(self, key):
        """What the server says that a key is."""
        kind, name, *rest = key
        if kind == "map":
            answer = self.client.ask("GET", f"/v1/maps/{name}")
            return answer.json()["description"] if answer.status == 200 else self.absence(key, answer)
        if kind == "keyframe":
            answer = self.client.ask("GET", f"/v1/maps/{name}/keyframes/{rest[0]}")
            return answer.json() if answer.status == 200 else self.absence(key, answer)
        if kind == "anchor":
            return self.living_anchor(name, rest[0], key)
        if name not in self.loops:
            self.loops[name] = self.all_loops(name)
        return True if rest[0] in self.loops[name] else ABSENT

    def absence(self, key, answer):
        if answer.status != 404:
            self.wrong.append(f"{key}: {answer}")
        return ABSENT

    def living_anchor(self, name, anchor, key):
        answer = self.client.ask("GET", f"/v1/maps/{name}/anchors/{anchor}")
        if answer.status != 200:
            return self.absence(key, answer)
        return answer.json()["description"]

    def all_loops(self, name):
        ids, cursor = set(), ""
        while True:
            answer = self.client.ask("GET", f"/v1/maps/{name}/loops?limit=1000{cursor}")
            if answer.status != 200:
                return ids
            page = answer.json()
            ids.update(item["id"] for item in page["items"])
            if page["next_cursor"] is None:
                return ids
            cursor = f"&cursor={page['next_cursor']}"

    def check(self, robot, moment, settle):
        """Every key has a state that it may have at a moment (None: now). `settle`: what is found is there to stay."""
        may, actual = {}, {}
        for write in robot.history:
            if moment is not None and write.sent > moment:
                continue
            sure = write.acknowledged is not None and (moment is None or write.acknowledged <= moment)
            for key, state in write.states.items():
                if sure:
                    may[key] = [(write, state)]
                else:
                    may.setdefault(key, [(None, ABSENT)]).append((write, state))
        for key, states in may.items():
            actual[key] = self.kept(key)
            self.checked += 1
            if not any(matches(key, state, actual[key]) for _, state in states):
                self.lost.append(f"{robot.robot} {key}: {short(actual[key])}, and not one of "
                                 f"{[(w and w.what, w and w.status, short(s)) for w, s in states]}")
        for write in robot.history:
            if moment is not None and write.sent > moment:
                continue
            if write.states and not (write.acknowledged and (moment is None or write.acknowledged <= moment)):
                self.doubt(robot, write, may, actual, settle)
        for name, version in robot.versions.items() if moment is None else ():
            answer = self.client.ask("GET", f"/v1/maps/{name}")
            if answer.status == 200 and answer.json()["map_version"] < version:
                self.wrong.append(f"{name}: version {answer.json()['map_version']} after {version}")
        return actual

    def doubt(self, robot, write, may, actual, settle):
        last = {key: states[-1][0] is write for key, states in may.items() if key in write.states}
        if not all(last.values()):
            return  # Something came after it.
        there = {matches(key, write.states[key], actual[key]) for key in write.states}
        if len(there) > 1:
            self.wrong.append(f"{robot.robot}: {write.what} {list(write.states)} is there in part")
        elif there == {True}:
            self.found += 1
            if settle:
                write.acknowledged = write.acknowledged or robot.clock()
        else:
            self.absent += 1

    def faults(self):
        return self.lost + self.wrong

    def expect_no_fault(self, when):
        if self.faults():
            fail(f"{when}: {self.faults()[:3]}")

    def add_to(self, figures):
        figures["lost"] += len(self.lost)
        figures["in doubt, found"] += self.found
        figures["in doubt, absent"] += self.absent


def matches(key, state, actual):
    if state is ABSENT or actual is ABSENT:
        return state is actual
    return same(state, actual)


def short(state):
    text = json.dumps(state)
    return text if len(text) < 120 else f"{text[:120]}..."
