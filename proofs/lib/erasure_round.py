"""One database, its server, which gets SIGKILL now and then, and the histories of requests that are sent to it."""

import collections
import contextlib
import json
import random
import sqlite3
import subprocess
import threading
import time

from erasure_reads import search_answers
from erasure_robots import Map, Robot
from erasure_store import STORES
from marks import Hunt, Owner, Side
from server import Gone, Server


class Round:
    def __init__(self, program, folder, engine, seed, kills, figures, models, is_short):
        self.program, self.folder, self.figures, self.models = program, folder, figures, models
        self.seed, self.kills, self.is_short = seed, kills, is_short
        self.store, self.chance = STORES[engine](folder, seed), random.Random(seed)
        self.log, self.log_from = folder / "server.log", 0
        (folder / "backups").mkdir()
        (folder / "tmp").mkdir()
        # A history has a map, its copies and its robots; a database may have several.
        self.map, self.maps, self.robots, self.every_map = None, [], [], []
        self.gone = Side(self.chance)
        self.kept = Side(self.chance, self.gone)
        self.trail, self.timer, self.starts, self.names = [], None, 0, 0
        self.reported = set()
        models.free.set()
        self.start()

    def begin(self, name):
        """Begins a history in a map of its own."""
        self.history = name
        self.map, self.maps, self.robots = Map(name.replace("_", "-")), [], []
        self.add(self.map)
        self.send("map", "PUT", self.map.path, {"description": "a tower"})

    def add(self, of):
        self.maps.append(of)
        self.every_map.append(of)

    def robot(self, name, doomed, session_of=None):
        robot = Robot(Owner(self.gone if doomed else self.kept, f"{name} of {self.map.name}"), self.chance, doomed, session_of)
        self.robots.append(robot)
        return robot

    def doomed(self):
        return [robot for robot in self.robots if robot.doomed]

    def staying(self):
        return [robot for robot in self.robots if not robot.doomed]

    def any_robot(self):
        return self.chance.choice(self.robots)

    def name(self, kind):
        self.names += 1
        return f"{kind}-{self.names}"

    def start(self):
        self.starts += 1
        # Another name is another model, to which a judgement puts the questions again.
        flags = ["--log", "info,sqlx=warn", "--backups", str(self.folder / "backups"), "--backups-kept", "99",
                 *self.models.flags(f"small-{self.starts % 2}")]
        self.server = Server(self.program, self.store.url, *flags, log=self.log, env={"SQLITE_TMPDIR": str(self.folder / "tmp")})
        self.client = self.server.client(timeout=120)

    def kill_soon(self, within):
        """SIGKILL after a random moment."""
        self.timer = threading.Timer(self.chance.uniform(0, within), self.server.kill)
        self.timer.start()

    def settle(self):
        """Lets a kill that is due happen."""
        if self.timer is not None:
            self.timer.join()
            self.timer = None
            self.figures["kills"] += 1
            self.start()

    def ask(self, method, path, body=None, **more):
        while True:
            try:
                answer = self.client.ask(method, path, body, **more)
            except Gone:
                if self.timer is None:
                    raise AssertionError(f"the server is gone and was not killed: {self.server.last_words()}") from None
                self.settle()
                continue
            if answer.status != 503:
                return answer
            # On PostgreSQL a map is the dead server's until its lease ends.
            time.sleep(0.1)

    def send(self, what, method, path, body=None, may=(), **more):
        """One request of a history, repeated after a kill until it has an answer."""
        if self.kills and self.store.name == "sqlite" and self.timer is None and self.chance.random() < 0.03:
            self.kill_soon(0.02)
        self.trail.append(f"{method} {path} {json.dumps(body)[:160] if body is not None else ''}")
        answer = self.ask(method, path, body, **more)
        done = answer.status < 300
        self.figures[what if done else f"{what} refused"] += 1
        if not done and answer.status not in may:
            raise AssertionError(f"{method} {path}: {answer}\n{json.dumps(body)[:2000]}")
        self.trail[-1] += f" -> {answer.status}"
        return answer

    def wrong(self, text):
        self.figures.faults.append(text)
        print(f"FAULT ({self.history} on {self.store.name}, seed {self.seed}): {text}", flush=True)

    def search_files(self, hunt):
        found = self.store.search(hunt) + hunt.search_folder(self.folder / "tmp")
        with open(self.log, "rb") as log:
            log.seek(self.log_from)
            return found + hunt.search("the server's log", log.read())

    def search(self, hunt, maps):
        found = self.search_files(hunt) + self.store.search_copies(hunt, self)
        return found + [find for of in maps for find in search_answers(self, hunt, of)]

    def hunt(self, when, search):
        """Looks for all marks of what was erased."""
        hunt = Hunt(self.gone, self.store.is_hexadecimal)
        self.report(when, search(hunt))
        self.figures["marks looked for"] += sum(len(owner.given) for owner in hunt.side.owners)
        self.figures["MiB searched"] += hunt.bytes / 2**20
        self.figures.places |= hunt.places

    def hunt_everywhere(self, when):
        self.hunt(when, lambda hunt: self.search(hunt, self.every_map))

    def show(self):
        """That the search can find: in the same places it finds marks of what stays."""
        hunt, of = Hunt(self.kept, self.store.is_hexadecimal), self.every_map[0]
        hunt.most = 1
        places = {find.place for find in self.search(hunt, [of])}
        must = self.store.shows + [f"answer {of.path}/{part}" for part in ("keyframes", "sessions", "export")]
        missing = [place for place in must if not any(one.startswith(place) for one in places)]
        if missing:
            raise AssertionError(f"the search finds nothing of those that stay in {missing}, only in {sorted(places)}")

    def report(self, when, found):
        """Tells of each kind of mark once for each set of columns that has it."""
        self.figures["marks found"] += len(found)
        kinds = collections.defaultdict(list)
        for find in found:
            find.tell()
            kinds[find.owner, find.what, find.kind].append(find)
        for key, finds in kinds.items():
            places = sorted({find.place for find in finds})
            columns = places
            # A server that is gone has given its file to nobody.
            with contextlib.suppress(sqlite3.Error):
                columns = self.store.where({find.bytes for find in finds}) or places
            if (key, *columns) not in self.reported:
                self.reported.add((key, *columns))
                line = f"{finds[0]}\n      {when}, in {', '.join(columns)}; places: {', '.join(places)}"
                print(f"FOUND ({self.history} on {self.store.name}, seed {self.seed}): {line}", flush=True)
                self.figures.faults.append(line)

    def stop(self):
        self.settle()
        # The server waits for connections that are open.
        self.client.close()
        self.server.stop()

    def close(self):
        self.history = "all histories"
        self.show()
        self.hunt_everywhere("when all erasures are done")
        self.stop()
        if self.store.name == "sqlite":
            self.hunt("after the server has ended", self.search_files)
            check = subprocess.run([self.program, "check", "--database", self.store.url], capture_output=True, text=True)
            if check.returncode:
                self.wrong(f"check: {check.stdout[-1500:]}")

    def abandon(self):
        if self.timer:
            self.timer.join()
        self.server.abandon()
