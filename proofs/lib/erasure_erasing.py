"""Erases what is to go, with kills meanwhile, and compares what the erasures tell and what stays with what was there."""

import json
import time

from erasure_reads import counted, items, search_answers, stays
from marks import Hunt
from server import expect

# An erasure goes on after a kill; longer than this it hangs.
DONE_S = 60


def erase_all(round, orders=None, kills=None, during=None):
    """Erases all that is to go, first in the map, then in each that began as its copy."""
    kills = round.kills if kills is None else kills
    before = {of.name: stays(round, of) for of in round.maps}
    first = round.store.search(Hunt(round.gone, round.store.is_hexadecimal))
    round.figures["marks before"] += len(first)
    if not first:
        raise AssertionError("the search finds nothing before the erasure")
    for of in list(round.maps):
        erase(round, of, orders or orders_of(round, of), kills, during)
        # Copies still have it. A single map is searched when all is done.
        found = search_answers(round, Hunt(round.gone), of) if len(round.maps) > 1 else []
        round.report(f"in answers about {of.name}", [find for find in found if of.path in find.place])
        after = stays(round, of)
        for name, body in before[of.name].items():
            if after.get(name) != body:
                round.wrong(f"keyframe {name} of {of.name} stays, and is another: {differs(body, after.get(name))}")
                break
        round.figures["keyframes that stay compared"] += len(after)


def differs(before, after):
    if after is None:
        return "it is gone"
    one, other = json.loads(before), json.loads(after)
    return "; ".join(f"{field}: {json.dumps(one.get(field))[:300]} -> {json.dumps(other.get(field))[:300]}"
                     for field in one | other if one.get(field) != other.get(field))


def orders_of(round, of):
    """What is asked for: all sessions that are to be erased at once or in turn, and the keyframes of groups."""
    chance, doomed = round.chance, round.doomed()
    sessions = [robot.session for robot in doomed if not robot.is_group]
    sessions = sorted({of.whole(session) for session in sessions})
    chance.shuffle(sessions)
    orders = [{"keyframes": names} for robot in doomed if robot.is_group and (names := of.of(robot) + robot.culled)]
    if sessions:
        cut = chance.randrange(1, len(sessions) + 1) if chance.random() < 0.5 else len(sessions)
        orders += [{"sessions": part} for part in (sessions[:cut], sessions[cut:]) if part]
    chance.shuffle(orders)
    return orders


def erase(round, of, orders, kills, during):
    doomed = {name for name, robot in of.keyframes.items() if robot.doomed}
    expect_keyframes(round, of, "before the erasure")
    releases_before = counted(round, of)
    for order in orders:
        answer = ask(round, of, order, may=(422,))
        if answer.status == 422:
            # A part of another session in a version: the answer says to erase that one as well.
            answer = ask(round, of, {"sessions": sorted({robot.session for robot in round.doomed() if not robot.is_group})})
        left = [round.chance.choice([0.005, 0.02, 0.06, 0.2]) for _ in range(kills)]

        def meanwhile():
            if left and round.timer is None:
                round.kill_soon(left.pop())
            if during:
                during(round)

        done(round, of, answer.json()["id"], meanwhile)
    round.settle()
    # One that was asked for when the server was killed is another erasure of the same.
    told, number = [], 1
    while round.ask("GET", f"{of.path}/erase/e-{number}").status == 200:
        told.append(done(round, of, f"e-{number}"))
        number += 1
    round.log_from = round.log.stat().st_size
    of.keyframes = {name: robot for name, robot in of.keyframes.items() if not robot.doomed}
    releases_after = counted(round, of)
    round.figures["erasures"] += len(told)
    round.figures["keyframes erased"] += len(doomed)
    round.figures["keyframes erased from releases"] += sum(releases_before.values()) - sum(releases_after.values())
    keyframes, releases = (sum(one[field] for one in told) for field in ("keyframes", "releases"))
    if keyframes != len(doomed):
        round.wrong(f"the erasures of {of.name} tell {keyframes} keyframes of the map, and it had {len(doomed)}; kills meanwhile: {kills}")
    expect_keyframes(round, of, "after the erasure")
    lost = sum(releases_before[name] != releases_after[name] for name in of.releases)
    if not lost <= releases <= (lost + of.published_meanwhile) * len(orders):
        round.wrong(f"the erasures of {of.name} tell {releases} releases that keyframes were removed from, and there were {lost}; "
                    f"kills meanwhile: {kills}")


def ask(round, of, order, may=()):
    return round.send("erasure", "POST", f"{of.path}/erase", order, may=may)


def expect_refused(round, of, order, why):
    answer = ask(round, of, order, may=(422,))
    if answer.status != 422:
        round.wrong(f"{why}, and its erasure is not refused: {answer}")


def done(round, of, name, meanwhile=lambda: None):
    """The erasure when it is done."""
    end = time.monotonic() + DONE_S
    while True:
        meanwhile()
        state = expect(round.ask("GET", f"{of.path}/erase/{name}"), 200).json()
        if state["state"] == "done":
            return state
        if time.monotonic() > end:
            raise AssertionError(f"an erasure is {state['state']} after {DONE_S} s")
        time.sleep(0.005)


def expect_keyframes(round, of, when):
    """What is stored is what was acknowledged."""
    stored = set(items(round, f"{of.path}/keyframes", "id"))
    if stored != set(of.keyframes):
        round.wrong(f"{of.name} has {len(stored)} keyframes {when}, and should have {len(of.keyframes)}")
