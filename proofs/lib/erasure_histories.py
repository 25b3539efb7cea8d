"""Histories of requests, each of which ends with its erasures: a random one, and such as are likely to leave something."""

import concurrent.futures
import contextlib
import threading
import time

from erasure_erasing import erase_all, expect_refused
from erasure_requests import ask, bulk, correct, delete, live, merge_into, put, release, store, unmerge
from erasure_robots import at
from server import Gone


def at_random(round, of):
    for number in range(3):
        round.robot(f"stays-{number}", doomed=False)
    for number in range(3):
        round.robot(f"goes-{number}", doomed=True)
    round.robot("group", doomed=True, session_of=round.robots[0])
    live(round, round.chance.randrange(40, 60) if round.is_short else round.chance.randrange(60, 200))
    erase_all(round, during=round.chance.choice([None, meanwhile]))
    round.hunt_everywhere("when all erasures are done")
    # Those that stay write on, and nothing comes back.
    for robot in round.staying():
        ask(round, of, {"keyframe": put(round, of, robot)})
    round.settle()


def meanwhile(round):
    """Robots that stay write and ask while others are erased; what they are told may name those."""
    robot, of = round.chance.choice(round.staying()), round.map
    name, body = robot.new(of)
    # What stays is compared: it moves no point of theirs.
    body["map_points"] = {"ids": [], "positions": []}
    if round.ask("PUT", f"{of.path}/keyframes/{name}?query=loop", body).status in (200, 201):
        of.keyframes[name] = robot
    for version in ({}, *({"release": name} for name in of.releases)):
        round.ask("POST", f"{of.path}/loop-queries", {"inline": body} | version)


def several(round, of, doomed=2, stays=1):
    """Robots that stay, and robots to be erased, each with a few keyframes."""
    robots = [round.robot(f"stays-{number}", doomed=False) for number in range(stays)] + [round.robot(name, doomed=True) for name in "xyz"[:doomed]]
    for robot in 3 * robots:
        put(round, of, robot)
    return robots


def wait(condition):
    """For what should come soon, and need not."""
    until = time.monotonic() + 5
    while not condition() and time.monotonic() < until:
        time.sleep(0.02)


def released_then_merged(round, of):
    """Publish, merge x into y, erase y."""
    _, x, y = several(round, of)
    release(round, of)
    merge_into(round, of, x, y)
    put(round, of, y)
    erase_all(round, [{"sessions": [y.session]}])


def merge_in_a_release_alone(round, of):
    """Merge, publish, revoke the merge, erase x: refused until y is erased too."""
    _, x, y = several(round, of)
    merge_into(round, of, x, y)
    release(round, of)
    unmerge(round, of, may=())
    expect_refused(round, of, {"sessions": [x.session]}, "a release knows x as a part of y")
    erase_all(round, [{"sessions": [y.session]}])


def only_asked(round, of):
    """A session that is nowhere stored asked a release, and the map."""
    several(round, of, doomed=0, stays=2)
    asks, x = round.robot("asks", doomed=True), round.robot("x", doomed=True)
    release(round, of)
    put(round, of, x)
    for version in ({"release": next(iter(of.releases))}, {}):
        for robot in (asks, x):
            ask(round, of, {"inline": robot.body(of)} | version)
    # Uses are written behind.
    wait(lambda: asks.session.encode() in round.ask("GET", f"{of.path}/releases").body)
    erase_all(round, [{"sessions": [asks.session, x.session]}])


def former_positions(round, of):
    """Points of one number in every session, corrected again and again, also after a merge and in one that was revoked."""
    robots = _, x, y, z = several(round, of, doomed=3)
    for turn in range(3):
        for robot in robots:
            correct(round, of, robot, list(range(8)))
        if turn == 0:
            merge_into(round, of, x, y)
            unmerge(round, of, may=())
        if turn == 1:
            merge_into(round, of, x, z)
    fused = {"session": z.session, "replaced": [[3, 4], [z.owner.point(1), 5]], "removed": [6, z.owner.point(2)]}
    round.send("observations", "POST", f"{of.path}/observations", fused)
    erase_all(round)


def merge_of_both_kinds(round, of):
    """A session that stays was merged into one that is erased, and the other way round; both merges were revoked. Then it brings points whose
    numbers the other one had."""
    stays, x, y = several(round, of)
    for one, other in ((stays, x), (y, stays)):
        merge_into(round, of, one, other)
        ask(round, of, {"keyframe": of.of(one)[0]})
        unmerge(round, of, may=())
    for _ in range(5):
        put(round, of, stays)
    erase_all(round)


def numbers_learned(round, of):
    """A class of its own with enough numbers for the map to learn how they are written."""
    _, x = several(round, of, doomed=1)
    kind = x.owner.text("a class", "sign ")
    for number in [*range(12)] * 2:
        sign = x.painting(0, 5.0 * number) | {"class": kind, "confidence": 0.95, "text": f"{300 + number}"}
        del sign["description"]
        store(round, of, x, x.body(of) | {"detections": [sign]})
    round.figures["classes of marks with numbers learned"] += kind in round.ask("GET", of.path).json()["numbering"]
    erase_all(round)


def frame_of_a_plan(round, of):
    """A session with signs of a plan in its frame is erased when they are gone."""
    _, x = several(round, of, doomed=1)
    plan = round.robot("plan", doomed=True)
    owner, paths = plan.owner, []
    for _ in range(3):
        sign = {"class": "door_number", "description": owner.text("a sign of a plan", "office "), "frame": plan.session,
                "source": owner.text("a plan's source"), "position": [owner.metres("a sign of a plan"), 4.0, 1.5],
                "normal": [owner.unit("a sign of a plan") for _ in range(3)]}
        paths.append(f"{of.path}/anchors/{owner.text('the name of a sign of a plan')}")
        round.send("prior anchor", "PUT", paths[-1], sign)
    expect_refused(round, of, {"sessions": [plan.session]}, "signs of a plan are in its frame")
    for path in paths:
        round.send("prior anchor gone", "DELETE", path)
    erase_all(round, [{"sessions": [x.session, plan.session]}])


def deleted_before(round, of):
    """Keyframes that were deleted, with loops that name them, before their session is erased."""
    stays, x = several(round, of, doomed=1)
    release(round, of)
    for number, name in enumerate(of.of(x)):
        loop = {"id": f"loop-{number}", "keyframe": name, "candidate": of.of(stays)[0], "candidate_from_query": at(x.owner.metres("a loop"))}
        round.send("loop", "POST", f"{of.path}/loops", loop)
    for name in of.of(x):
        delete(round, of, name)
    erase_all(round, [{"sessions": [x.session]}])


def corrected_and_erased(round, of):
    """A large correction is under way into its rows when the erasure is asked for."""
    _, x = several(round, of, doomed=1)
    points = list(range(20_000))
    store(round, of, x, x.body(of) | {"observes": points})
    for _ in range(2):
        correct(round, of, x, points)
    erase_all(round)


def counted_under_kills(round, of):
    """Many keyframes, in the map and in two releases, and as many kills as there is time for."""
    _, x, y = several(round, of)
    for robot in (x, y, x, y):
        bulk(round, of, robot, 20)
        if len(of.releases) < 2:
            release(round, of)
    erase_all(round, kills=4 * round.kills)


def published_meanwhile(round, of):
    """A release is published, robots write and ask, and others read, while sessions are erased."""
    several(round, of, doomed=3, stays=2)
    release(round, of)
    base, stop = of.path, threading.Event()
    works = [[("PUT", f"{base}/releases/r-meanwhile", {})], [("GET", f"{base}/export", None), ("GET", f"{base}/frames", None)],
             [("POST", f"{base}/loop-queries", {"keyframe": name}) for name in of.keyframes]]
    of.published_meanwhile = 1
    with concurrent.futures.ThreadPoolExecutor() as pool:
        for work in works:
            pool.submit(beside, round.server, work, stop)
        try:
            erase_all(round, kills=0, during=meanwhile)
        finally:
            stop.set()


def beside(server, requests, stop):
    client = server.client()
    with contextlib.suppress(Gone):
        while not stop.is_set():
            for method, path, body in requests:
                client.ask(method, path, body)


def judgement_under_way(round, of):
    """A model is asked again about texts that are erased meanwhile, and answers when all is done."""
    stays, x, y = several(round, of)
    for robot in (x, y, stays):
        store(round, of, robot, robot.body(of) | {"detections": [robot.painting(place, 9.0 * place) for place in range(4)]})
    round.models.settled()
    # With another name of the model its questions are asked again. A few are answered, the next one waits.
    round.stop()
    round.models.hold(after=round.chance.randrange(2, 16))
    round.start()
    round.figures["questions of a judgement under way"] += round.send("judgement", "POST", f"{of.path}/judgements", {"id": round.name("j")}).json()["questions"]
    erase_while_asked(round)


def texts_waiting_for_a_model(round, of):
    """A model is being asked about a new text when it is erased, and answers when all is done."""
    round.models.settled()
    round.models.hold()
    _, x = several(round, of, doomed=1)
    put(round, of, x)
    store(round, of, x, x.body(of) | {"detections": [x.painting(0)]})
    erase_while_asked(round)


def erase_while_asked(round):
    wait(lambda: round.models.holding)
    try:
        # A question that is under way goes with a kill.
        erase_all(round, kills=0 if round.seed % 2 else None)
    finally:
        round.models.free.set()
    round.models.settled()


# In this order: each erasure empties the cache of models' answers, so what comes to it late is looked for after the last one.
HISTORIES = [at_random, released_then_merged, merge_in_a_release_alone, only_asked, former_positions, merge_of_both_kinds, numbers_learned,
             frame_of_a_plan, deleted_before, corrected_and_erased, counted_under_kills, published_meanwhile, judgement_under_way,
             texts_waiting_for_a_model]
# What takes seconds on PostgreSQL.
SLOW = [at_random, corrected_and_erased, counted_under_kills, published_meanwhile]
