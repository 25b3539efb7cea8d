"""The load of the soak: robots that do all that clients do, on maps that stay as large as they are.

For every keyframe that a robot writes it culls an old one, and after each it does one thing more, in turn. Whatever it makes it also
takes away: loops, merges of sessions, releases, copies, prior anchors. Half of the robots delete their map after some laps and make
another one of another name; the others stay on patrol in one map, with map points that they never saw before, until the rows that a map
never lets go of (its history, lines of verdicts) would be more than a little.
"""

import base64
import gzip
import http.client
import json
import random
import threading
import time

from robots import POINTS, STEP, keyframe, pose

ROBOTS = 6
KEYFRAMES, LAPS = 60, 4
PATROL_S = 600
FEATURES, DESCRIPTOR = 96, 32
RENUMBERED = 2**40
TURNS_A_CONNECTION = 64
# An erasure rewrites the file, and a backup reads all of it.
ERASED_EVERY_S, BACKED_UP_EVERY_S = 90, 300
GUESTS = 3
TEXTS = ["a red boat at sea", "a sailing ship, red", "Level 5", "EXIT", "room 901", "Ärztehaus", "出口 3", "a fire door"]


class Pace:
    """When the requests of one of the robots are due. What could not be asked in time is not caught up with."""

    def __init__(self, rate, fast_until):
        self.step, self.fast_until = ROBOTS / rate, fast_until
        self.next = time.monotonic()

    def wait(self):
        if (now := time.monotonic()) > self.fast_until:
            self.next = max(self.next + self.step, now - 1)
            time.sleep(max(0.0, self.next - now))


class Load(threading.Thread):
    """One robot."""

    def __init__(self, server, number, rate, fast_until, without=(), backs_up=False):
        super().__init__(daemon=True)
        self.client, self.number, self.robot = server.client(), number, f"soak{number}"
        self.stays, self.backs_up = number % 2 == 0, backs_up and number == 1
        self.pace = Pace(rate, fast_until)
        self.stopping, self.trouble = threading.Event(), None
        self.latencies, self.asked, self.lives, self.done, self.refused = [], 0, 0, {}, 0
        self.chance = random.Random(self.robot)
        self.operations = [name for name in OPERATIONS if name not in without]
        self.erases = "erase" not in without
        # Not all at once, and the first patrols end at different times.
        self.erased = time.monotonic() - ERASED_EVERY_S * ROBOTS * self.chance.random()
        self.backed_up = time.monotonic()
        self.began = time.monotonic() - (PATROL_S * number / ROBOTS)
        self.bodies = {}
        self.asked_last = None

    def run(self):
        try:
            while not self.stopping.is_set():
                self.live()
        except Exception as trouble:  # told by whoever watches this thread
            self.trouble = trouble

    def ask(self, method, path, body=None, headers=(), raw=None, expect=(200, 201, 204), kind="application/json"):
        self.pace.wait()
        began = time.monotonic()
        answer = self.client.ask(method, path, body, headers, raw, kind)
        self.latencies.append(time.monotonic() - began)
        self.asked += 1
        if answer.status not in expect:
            raise AssertionError(f"{method} {path}: {answer}")
        return answer

    def begin(self, method, path, body=None):
        """Asks for what few may do at once; whether it was done."""
        done = self.ask(method, path, body, expect=(200, 201, 503)).status != 503
        self.refused += not done
        return done

    def live(self):
        """One map, from its making to its end."""
        self.lives += 1
        self.at = f"/v1/maps/{self.robot}-{self.lives}"
        self.ask("PUT", self.at, {"description": "soak", "settings": {"keep_history": self.number % 3 == 0}})
        for number in range(KEYFRAMES):
            self.ask("PUT", f"{self.at}/keyframes/k{number}", self.body(number))
        number = KEYFRAMES
        while not self.stopping.is_set() and not self.is_over(number):
            self.turn(number)
            number += 1
        self.began = time.monotonic()
        self.ask("DELETE", self.at)

    def is_over(self, number):
        if self.stays:
            return time.monotonic() - self.began > PATROL_S
        return number >= KEYFRAMES * (1 + LAPS)

    def session(self, number):
        """Two sessions, by turns: each of them has keyframes at all times."""
        return f"{self.robot}-{'ab'[number % 2]}"

    def body(self, number):
        # The same corridor again and again, as a robot on patrol walks it.
        place = number % KEYFRAMES
        if place not in self.bodies:
            self.bodies[place] = self.seen_at(place)
        # Nothing lies where it lay, for those who stay: every lap is of points of its own.
        first = place * STEP + (number // KEYFRAMES * KEYFRAMES * POINTS if self.stays else 0)
        ids = list(range(first, first + POINTS))
        body = dict(self.bodies[place])
        positions = body["map_points"]["positions"]
        body |= {"session": self.session(number), "observes": ids, "map_points": {"ids": ids, "positions": positions}}
        body["features"] = body["features"] | {"map_points": ids + [-1] * (FEATURES - POINTS)}
        body["detections"] = [
            detection | ({"map_points": ids[:6]} if "map_points" in detection else {}) for detection in body.get("detections", [])
        ]
        return body

    def seen_at(self, place):
        chance = random.Random(f"{self.robot} {place}")
        body = keyframe("corridor", place)
        body["features"] = {
            "descriptor_bytes": DESCRIPTOR,
            "descriptors": base64.b64encode(chance.randbytes(FEATURES * DESCRIPTOR)).decode(),
            "keypoints": [[chance.randrange(6400) / 10, chance.randrange(4800) / 10, chance.randrange(8)] for _ in range(FEATURES)],
        }
        body["global_descriptor"] = {
            "model": "soak", "encoding": "int8", "data": base64.b64encode(random.Random(place).randbytes(256)).decode(),
        }
        return body

    def turn(self, number):
        old = number - KEYFRAMES
        if number % TURNS_A_CONNECTION == 0:
            self.client.close()
        self.asked_last = self.ask("PUT", f"{self.at}/keyframes/k{number}?query=loop", self.body(number)).json()
        self.ask("DELETE", f"{self.at}/keyframes/k{old}")
        some = self.chance.randrange(old + 1, number)
        if self.operations:
            # Robots in step would do the same at once.
            name = self.operations[(number + 4 * self.number) % len(self.operations)]
            getattr(self, name)(number, some)
            self.done[name] = self.done.get(name, 0) + 1
        now = time.monotonic()
        if self.erases and now - self.erased > ERASED_EVERY_S * ROBOTS:
            self.erased = now
            self.erase(number)
        if self.backs_up and now - self.backed_up > BACKED_UP_EVERY_S:
            self.backed_up = now
            self.ask("POST", "/v1/backups", {}, expect=(200, 201))

    # One of these in each turn.

    def loop(self, number, some):
        self.ask("POST", f"{self.at}/loops", {"id": f"l{number}", "keyframe": f"k{number}", "candidate": f"k{some}"})
        self.ask("GET", f"{self.at}/loops")
        self.ask("DELETE", f"{self.at}/loops/l{number}")

    def query(self, number, some):
        answer = self.ask("POST", f"{self.at}/loop-queries", {"keyframe": f"k{some}", "seed": number, "verify": "geometry"}).json()
        self.ask("GET", f"{self.at}/loop-queries/{answer['id']}")

    def poses(self, number, some):
        moved = pose((some % KEYFRAMES) * 0.5, self.chance.randrange(1, 64) / 64)
        self.ask("POST", f"{self.at}/poses", {"session": self.session(some), "keyframes": {"ids": [f"k{some}"], "poses": [moved]}})

    def anchors(self, number, some):
        for anchor in self.ask("GET", f"{self.at}/anchors?limit=5").json()["items"][:1]:
            self.ask("PATCH", f"{self.at}/anchors/{anchor['id']}", {"description": f"by hand {number}"}, {"if-match": "*"},
                     expect=(200, 404))

    def reads(self, number, some):
        self.ask("GET", f"{self.at}/keyframes/k{some}")
        self.ask("GET", f"{self.at}/keyframes/k{some}/covisible")
        self.ask("GET", f"{self.at}/keyframes/k{some}/local-anchor-map")

    def texts(self, number, some):
        pair = {"class": "sign", "a": f"Room {number}", "b": f"room {number + 1}"}
        self.ask("POST", "/v1/semantics/similarity", pair)
        self.ask("POST", "/v1/semantics/merge", pair)
        self.ask("POST", "/v1/semantics/information", {"class": "sign", "text": f"Level {number}"})
        self.ask("GET", f"{self.at}/nowhere-{number}", expect=(404,))

    def settings(self, number, some):
        self.ask("PATCH", self.at, {"description": f"lap {number}"})
        self.ask("PATCH", self.at, {"settings": {"candidates_max": 10 + number % 10}})
        self.ask("GET", self.at)

    def lists(self, number, some):
        for path in ("/v1/maps", f"{self.at}/sessions", f"{self.at}/keyframes?limit=20", f"{self.at}/keyframes?redundant=true"):
            self.ask("GET", path)

    def faults(self, number, some):
        self.ask("PUT", f"{self.at}/keyframes/bad", {"stamp": 1}, expect=(422,))
        self.ask("GET", f"/v1/maps/none-{number}", expect=(404,))

    def locate(self, number, some):
        unplaced = {name: value for name, value in self.body(some).items()
                    if name in ("bow", "camera", "features", "detections", "global_descriptor")}
        unplaced["features"] = {name: value for name, value in unplaced["features"].items() if name != "map_points"}
        unplaced["detections"] = [
            {name: value for name, value in detection.items() if name != "map_points"} for detection in unplaced["detections"]
        ]
        maps = [self.at.rsplit("/", 1)[1]] if number % 2 else ["soak*"]
        # One of all these may be deleted meanwhile.
        self.ask("POST", "/v1/locate", {"keyframe": unplaced, "maps": maps, "max": 3})

    def merge(self, number, some):
        """The two sessions become one, and two again."""
        moved = {"rotation": {"x": 0, "y": 0, "z": 0, "w": 1}, "translation": {"x": 0.25, "y": 0, "z": 0}}
        body = {"into": self.session(0), "into_from_session": moved, "map_points": {"offset": RENUMBERED}}
        at = f"{self.at}/sessions/{self.session(1)}/merge"
        self.ask("POST", at, body)
        self.ask("POST", f"{self.at}/loop-queries", {"keyframe": f"k{some}", "seed": number})
        self.ask("DELETE", at)

    def observations(self, number, some):
        """One point is another, one is none, and one keyframe sees fewer."""
        ids = self.body(some)["observes"]
        body = {"session": self.session(some), "replaced": [[ids[3], ids[4]]], "removed": [ids[5]]}
        self.ask("POST", f"{self.at}/observations", body)
        self.ask("POST", f"{self.at}/observations",
                 {"session": self.session(some), "keyframes": [{"keyframe": f"k{some}", "observes": ids[6:20]}]})

    def release(self, number, some):
        at = f"{self.at}/releases/r{number}"
        if not self.begin("PUT", at, {"description": "as it stands"}):
            return
        self.ask("POST", f"{self.at}/loop-queries", {"keyframe": f"k{some}", "release": f"r{number}", "verify": "geometry"})
        self.ask("GET", f"{self.at}/changes?since=r{number}")
        self.ask("GET", f"{self.at}/releases")
        self.ask("DELETE", at)

    def copy(self, number, some):
        at = f"{self.at}-copy-{number}"
        if not self.begin("PUT", at, {"base": {"map": self.at.rsplit("/", 1)[1]}}):
            return
        self.ask("POST", f"{at}/loop-queries", {"keyframe": f"k{some}", "verify": "geometry"})
        self.ask("DELETE", at)

    def trajectory(self, number, some):
        form = ("tum", "kitti", "g2o")[number % 3]
        self.ask("GET", f"{self.at}/trajectory?format={form}" + ("" if form == "g2o" else f"&session={self.session(0)}"))
        self.ask("GET", f"{self.at}/frames")

    def export(self, number, some):
        self.begin("GET", f"{self.at}/export")

    def verdicts(self, number, some):
        self.ask("GET", f"{self.at}/loop-queries?limit=50")
        self.ask("GET", f"{self.at}/loop-queries?verdict=loop&session={self.session(0)}")

    def usage(self, number, some):
        for path in ("/v1/usage", "/version", "/metrics", "/readyz"):
            self.ask("GET", path)

    def events(self, number, some):
        """Listens for as long as it takes to hear something."""
        self.pace.wait()
        stream = http.client.HTTPConnection(self.client.address, timeout=2)
        try:
            stream.request("GET", f"{self.at}/events?since=0")
            answer = stream.getresponse()
            if answer.status not in (200, 410):
                raise AssertionError(f"events: {answer.status}")
            answer.read1(4096)
        except TimeoutError:
            pass
        finally:
            stream.close()
        self.asked += 1

    def bulk(self, number, some):
        names = [f"b{number}-{line}" for line in range(4)]
        lines = [json.dumps({"id": name, **self.body(number + line)}) for line, name in enumerate(names)]
        self.ask("POST", f"{self.at}/keyframes", raw="\n".join(lines).encode(), kind="application/x-ndjson")
        for name in names:
            self.ask("DELETE", f"{self.at}/keyframes/{name}")

    def packed(self, number, some):
        """A compressed body, and a repeated one."""
        raw = gzip.compress(json.dumps(self.body(number)).encode(), 1)
        for _ in range(2):
            self.ask("PUT", f"{self.at}/keyframes/z{number}", raw=raw, headers={"content-encoding": "gzip"})
        self.ask("DELETE", f"{self.at}/keyframes/z{number}")

    def priors(self, number, some):
        at = f"{self.at}/anchors/plan:{number % 5}"
        self.ask("PUT", at, {"class": "door_number", "description": f"{900 + number % 5}", "frame": "plan", "normal": [0.0, 1.0, 0.0],
                             "position": [number % 5 * 3.0, 0.0, 1.5], "source": "soak"})
        self.ask("GET", f"{self.at}/anchors?prior=true")
        self.ask("DELETE", at, headers={"if-match": "*"})

    def opinions(self, number, some):
        """What a model is said to have said; always the same."""
        a, b = TEXTS[number % len(TEXTS)], TEXTS[(number + 1) % len(TEXTS)]
        self.ask("POST", f"{self.at}/model-verdicts", {"class": "sign", "level": 4, "operation": "similarity", "reason": "alike",
                                                       "source": "model:soak", "texts": [a, b]})

    # Seldom.

    def erase(self, number):
        """Guests come and are erased for good."""
        for guest in range(GUESTS):
            self.ask("PUT", f"{self.at}/keyframes/guest{guest}", self.body(number + guest) | {"session": "guest"})
        erasure = self.ask("POST", f"{self.at}/erase", {"sessions": ["guest"]}, expect=(202,)).json()["id"]
        self.done["erase"] = self.done.get("erase", 0) + 1
        while not self.stopping.is_set() and self.ask("GET", f"{self.at}/erase/{erasure}").json()["state"] != "done":
            time.sleep(0.2)


OPERATIONS = ("loop", "query", "poses", "anchors", "reads", "texts", "settings", "lists", "faults", "locate", "merge", "observations",
              "release", "copy", "trajectory", "export", "verdicts", "usage", "events", "bulk", "packed", "priors", "opinions")
