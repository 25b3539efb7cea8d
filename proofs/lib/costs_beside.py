"""What a robot of another map waits for while a costly request runs eight times at once."""

import itertools
import math
import multiprocessing
import threading
import time

from costs_measure import ask
from costs_shapes import in_row, keyframe, observed, signs, words
from server import Client, percentile

# A robot's requests are so far apart that it does not queue behind itself.
AT_ONCE, DUE_EVERY_S, QUIET_S, LEAST_S = 8, 0.1, 6.0, 8.0
# The limit of a p99: the larger of this and three times what it is when nothing else runs.
LIMIT_MS, FOLD = 250.0, 3
# How often a request is repeated, so that all of them last for a while.
TURNS_MOST = 24
# What is not refused for the moment.
REFUSED = (409, 429, 503)


def keyframe_of_the_neighbour(number):
    return keyframe(number, words(100, number % 500) | observed(50, number * 10) | signs(2, lambda i: f"Room {number + i}", lambda i: in_row(i, number)), 0.5)


def robot(address, key, first, ends, results):
    """A PUT and a query take turns, each due every so often; its latency counts from then."""
    client, times = Client(address), {"put": [], "query": []}
    due = time.monotonic()
    for number in itertools.count(first):
        if ends.is_set():
            break
        time.sleep(max(0.0, due - time.monotonic()))
        kind = "put" if number % 2 else "query"
        request = (ask("PUT", f"/v1/maps/neighbour/keyframes/n-{number}", keyframe_of_the_neighbour(number)) if number % 2 else
                   ask("POST", "/v1/maps/neighbour/loop-queries", {"keyframe": "n-1", "seed": number}))
        answer = client.ask(request.method, request.path, headers=key, raw=request.raw)
        if answer.status not in (200, 201, 503):
            results.put(f"{kind}: {answer}")
            return
        # One that is refused was not answered at all.
        times[kind].append(1e3 * (time.monotonic() - due) if answer.status != 503 else math.inf)
        due += DUE_EVERY_S
    results.put(times)


class Neighbour:
    """A map of its own on a ground's server, with a robot in it, which has a key; the costly requests have another one."""

    def __init__(self, ground):
        self.ground, self.first = ground, 1
        ground.administer()
        self.key, self.others_key = ground.key(), ground.key()
        ground.map((keyframe_of_the_neighbour(n) | {"id": f"n-{n}"} for n in range(1_000_000, 1_000_300)), name="neighbour")
        ground.do("PUT", "/v1/maps/neighbour/keyframes/n-1", keyframe_of_the_neighbour(1))
        self.first = 1001

    def beside(self, noise):
        """The p99 of its PUTs and queries while something happens."""
        ends, results = multiprocessing.Event(), multiprocessing.Queue()
        process = multiprocessing.Process(target=robot, args=(self.ground.server.address, self.key, self.first, ends, results), daemon=True)
        self.first += 100_000
        process.start()
        noise()
        ends.set()
        times = results.get(timeout=600)
        process.join()
        if isinstance(times, str):
            raise AssertionError(f"the neighbour: {times}")
        return {kind: percentile(each, 0.99) for kind, each in times.items()}

    def judged(self, requests):
        """The p99 when idle and beside these, a list for each client, and those above the limit."""
        self.ground.rest()
        idle = self.beside(lambda: time.sleep(QUIET_S))
        busy = self.beside(lambda: at_once(self.ground.server.address, self.others_key, requests))
        over = [kind for kind in busy if busy[kind] > max(LIMIT_MS, FOLD * idle[kind])]
        return idle, busy, over


def at_once(address, key, requests):
    """Each client sends its requests one after another; those that have ended begin again until a while is over, as far as they may
    be repeated."""
    ends = time.monotonic() + LEAST_S
    troubles = []

    def send(mine):
        client = Client(address, 600)
        try:
            for turn, request in enumerate(mine):
                if turn and time.monotonic() > ends:
                    break
                answer_to(request, key, client)
        except Exception as error:  # told by whoever joins
            troubles.append(error)
        client.close()

    threads = [threading.Thread(target=send, args=(mine,), daemon=True) for mine in requests]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(600)
    if troubles:
        raise troubles[0]


def answer_to(request, key, client):
    return request._replace(headers=(*key, *request.headers), statuses=(*request.statuses, *REFUSED)).send(client)
