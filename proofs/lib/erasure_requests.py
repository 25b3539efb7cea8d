"""Every kind of request that robots send: `live` sends random ones."""

import json

from erasure_robots import HALF_TURN, IDENTITY, OWN_POINTS, SHARED_POINTS, SIGNS, at
from server import expect

REFUSED = (404, 409, 412, 422)


def some(round, robot, of, most):
    names = of.of(robot)
    return round.chance.sample(names, min(most, len(names)))


def store(round, of, robot, body, query=""):
    name = robot.new_name()
    round.send("put with a query" if query else "put", "PUT", f"{of.path}/keyframes/{name}{query}", body)
    of.keyframes[name] = robot
    return name


def put(round, of, robot=None):
    robot, chance = robot or round.any_robot(), round.chance
    body = robot.body(of)
    if chance.random() < 0.4 and of.keyframes:
        near = chance.sample(sorted(of.keyframes), min(3, len(of.keyframes)))
        body["covisible"] = [{"keyframe": name, "shared": 20} for name in near]
    return store(round, of, robot, body, chance.choice(["", "", "?query=loop", "?query=loop&detail=brief"]))


def bulk(round, of, robot=None, count=4):
    robot = robot or round.any_robot()
    new = dict(robot.new(of) for _ in range(count))
    raw = "\n".join(json.dumps({"id": name} | body) for name, body in new.items()).encode()
    answer = round.send("bulk", "POST", f"{of.path}/keyframes", raw=raw, kind="application/x-ndjson")
    for line in answer.body.splitlines():
        if json.loads(line)["status"] not in (200, 201):
            raise AssertionError(f"bulk: {line}")
    of.keyframes |= dict.fromkeys(new, robot)


def delete(round, of, name):
    # A group names its keyframes when it is erased: also those that were deleted before, of which something may be left.
    round.send("cull", "DELETE", f"{of.path}/keyframes/{name}", may=(404,))
    of.keyframes.pop(name).culled.append(name)


def cull(round, of):
    for name in some(round, round.any_robot(), of, 1):
        delete(round, of, name)


def correct(round, of, robot, points, names=(), may=()):
    body = {"session": of.whole(robot.session), "map_points": robot.placed("a corrected position", points, 1.5)}
    if names:
        body["keyframes"] = {"ids": names, "poses": [at(robot.owner.metres("a corrected pose"), 3.5, 1.0) for _ in names]}
    round.send("poses", "POST", f"{of.path}/poses", body, may=may)


def poses(round, of):
    robot = round.any_robot()
    if names := some(round, robot, of, 4):
        points = [] if robot.is_group else round.chance.sample(range(SHARED_POINTS), 6)
        correct(round, of, robot, points, names, may=REFUSED)


def observations(round, of):
    robot, chance = round.any_robot(), round.chance
    names = some(round, robot, of, 2)
    if not names or robot.is_group:
        return
    own = [robot.owner.point(chance.randrange(OWN_POINTS)) for _ in range(3)]
    shared = chance.sample(range(SHARED_POINTS), 6)
    keyframes = [{"keyframe": name, "observes": sorted({*shared[4:], *own[1:]}), "covisible":
                  [{"keyframe": chance.choice(sorted(set(of.keyframes) - {name})), "shared": 31}] if len(of.keyframes) > 1 else []}
                 for name in names]
    body = {"session": of.whole(robot.session), "replaced": [[shared[0], shared[1]], [own[0], shared[2]]], "removed": [shared[3]],
            "keyframes": keyframes}
    round.send("observations", "POST", f"{of.path}/observations", body, may=REFUSED)


def loop(round, of):
    robot, chance = round.any_robot(), round.chance
    names = some(round, robot, of, 1)
    others = sorted(set(of.keyframes) - set(names))
    if not names or not others:
        return
    here, there = names[0], chance.choice(others)
    # A loop goes with either of its keyframes.
    owner = next((of.keyframes[name].owner for name in (here, there) if of.keyframes[name].doomed), robot.owner)
    # Its own id stays where its keyframe was deleted before: nobody knows then whose it was.
    name = f"loop-{chance.randrange(1 << 40)}"
    body = {"id": name, "keyframe": here, "candidate": there}
    if chance.random() < 0.6:
        body["candidate_from_query"] = at(owner.metres("a loop"))
    if chance.random() < 0.4:
        body["query"] = ask(round, of, {"keyframe": here}).json()["id"]
    round.send("loop", "POST", f"{of.path}/loops", body, may=REFUSED)
    of.loops.add(name)


def revoke(round, of):
    if of.loops:
        name = round.chance.choice(sorted(of.loops))
        round.send("revoke", "DELETE", f"{of.path}/loops/{name}", may=(404,))
        of.loops.remove(name)


def ask(round, of, body, may=()):
    return round.send("query of a release" if "release" in body else "query", "POST", f"{of.path}/loop-queries", body, may=may)


def query(round, of):
    robot, chance = round.any_robot(), round.chance
    names = some(round, robot, of, 1)
    body = {"keyframe": names[0]} if names and chance.random() < 0.6 else {"inline": robot.body(of)}
    if of.releases and chance.random() < 0.5:
        body["release"] = chance.choice(sorted(of.releases))
    ask(round, of, body, may=REFUSED)


def locate(round, of):
    robot = round.any_robot()
    body = {"keyframe": robot.body(of), "maps": [of.name]}
    if of.releases and round.chance.random() < 0.5:
        body["release"] = round.chance.choice(sorted(of.releases))
    body["exclude"] = {"sessions": [robot.session], "keyframes": some(round, robot, of, 2)}
    round.send("locate", "POST", "/v1/locate", body, may=REFUSED)


def merge_into(round, of, one, other, step=at(0.0), may=(), **more):
    into = of.whole(other.session)
    body = {"into": into, "into_from_session": step} | more
    answer = round.send("merge", "POST", f"{of.path}/sessions/{one.session}/merge", body, may=may)
    if answer.status < 300:
        of.merged[one.session], of.undo = into, one.session
    return answer.status < 300


def unmerge(round, of, may=REFUSED):
    """Revokes the last merge."""
    if of.undo:
        answer = round.send("merge revoked", "DELETE", f"{of.path}/sessions/{of.undo}/merge", may=may)
        if answer.status < 300:
            del of.merged[of.undo]
        of.undo = None


def merge(round, of):
    """Sessions that are erased merge with such, and the others with theirs. Any two merge where it is revoked at once."""
    chance, keep = round.chance, round.chance.random() < 0.6
    robots = [robot for robot in round.robots if not robot.is_group and of.whole(robot.session) == robot.session and of.of(robot)]
    if len(robots) < 2:
        return
    one, other = chance.sample(robots, 2)
    if keep and one.doomed != other.doomed:
        return
    points = chance.choice([{}, {"map_points": {"offset": 1000}}])
    if merge_into(round, of, one, other, at(0.0, 7.5, rotation=chance.choice([IDENTITY, HALF_TURN])), REFUSED, **points) and not keep:
        unmerge(round, of, may=())


def release(round, of):
    if of is round.map and len(of.releases) < 4:
        name = round.name("r")
        round.send("release", "PUT", f"{of.path}/releases/{name}", {"description": "as it stands"})
        of.releases[name] = of.copied(name)


def unrelease(round, of):
    if of.releases and round.chance.random() < 0.3:
        name = round.chance.choice(sorted(of.releases))
        round.send("release deleted", "DELETE", f"{of.path}/releases/{name}", may=(404,))
        del of.releases[name]


def copy(round, of):
    if of is not round.map or len(round.maps) >= 3:
        return
    name = round.name("copy")
    version = of.releases and round.chance.choice(sorted(of.releases))
    round.send("copy", "PUT", f"/v1/maps/{name}", {"base": {"map": of.name} | ({"release": version} if version else {})})
    round.add((of.releases[version] if version else of).copied(name))


def describe(round, of):
    """By hand: an anchor that only robots of one kind saw."""
    robot = round.any_robot()
    for name in some(round, robot, of, 1):
        stored = expect(round.ask("GET", f"{of.path}/keyframes/{name}"), 200).json()
        for anchor in [detection["anchor"] for detection in stored["detections"] if "anchor" in detection]:
            path = f"{of.path}/anchors/{anchor}"
            seen = round.ask("GET", path)
            if seen.status == 200 and all(of.keyframes.get(other) is robot for other in seen.json()["keyframes"]):
                text = {"description": robot.owner.word("a description by hand", "seen by hand, a boat of ")}
                round.send("description by hand", "PATCH", path, text, headers={"if-match": "*"}, may=REFUSED)
                if round.chance.random() < 0.2:
                    round.send("anchor deleted", "DELETE", path, may=REFUSED)
                return


def prior(round, of):
    sign = round.chance.choice(SIGNS)
    body = {"class": "door_number", "description": sign, "position": [1.0 * round.chance.randrange(9), 4.0, 1.5], "frame": "plan:9"}
    round.send("prior anchor", "PUT", f"{of.path}/anchors/{round.name('door')}", body, may=REFUSED)


def settings(round, of):
    body = {"settings": {"candidates_max": round.chance.randrange(5, 30), "description_min_crop_area_px": 1.0}}
    round.send("settings", "PATCH", of.path, body)


def verdict(round, of):
    """Of another model, about a robot's texts or its crops."""
    owner, chance = round.any_robot().owner, round.chance
    texts = [mark for mark, what in owner.given.items() if what in ("a text", "a description", "a description by hand")]
    if len(texts) < 2:
        return
    kind = chance.choice(["similarity", "information", "merge"])
    # Half of the pairs are of a mark and a text that everybody has.
    pair = chance.sample(texts, 2) if chance.random() < 0.5 else [chance.choice(texts), chance.choice(SIGNS)]
    body = {"source": "model:other", "reason": owner.text("a verdict's reason", "because "), "operation": kind,
            "class": chance.choice(["door_number", "painting"]), "texts": pair[:1] if kind == "information" else pair}
    body |= {"text": owner.text("a merged text", "both ")} if kind == "merge" else {"level": chance.randrange(1, 6)}
    round.send("model verdict", "POST", f"{of.path}/model-verdicts", body, may=REFUSED)


def reading(round, of):
    robot = round.any_robot()
    for name in some(round, robot, of, 1):
        body = {"operation": "describe", "keyframe": name, "detection": 0, "text": robot.owner.text("a reading", "a boat "), "source": "model:other"}
        round.send("model reading", "POST", f"{of.path}/model-verdicts", body, may=REFUSED)


def judgement(round, of):
    answer = round.send("judgement", "POST", f"{of.path}/judgements", {"id": round.name("j")}, may=REFUSED)
    if answer.status < 300 and round.chance.random() < 0.3:
        round.send("judgement stopped", "DELETE", f"{of.path}/judgements/{answer.json()['id']}", may=REFUSED)


def reads(round, of):
    for path in ("export", "frames", "anchors?limit=1000", "loop-queries?limit=100", "sessions"):
        round.send("read", "GET", f"{of.path}/{path}")


def backup(round, _):
    if round.store.name == "sqlite":
        round.send("backup", "POST", "/v1/backups", {})


OFTEN = [put] * 10 + [bulk, poses, poses, observations, loop, loop, query, query, cull, describe, verdict]
RARELY = [revoke, locate, merge, merge, unmerge, release, unrelease, copy, prior, settings, reading, judgement, reads, reads, backup]
# After these a merge cannot be revoked any more.
WRITES = [put, bulk, poses, observations, cull]


def live(round, requests):
    chance = round.chance
    for _ in range(requests):
        of = round.map if chance.random() < 0.8 else chance.choice(round.maps)
        kind = chance.choice(OFTEN if chance.random() < 0.7 else RARELY)
        kind(round, of)
        if kind in WRITES:
            of.undo = None
    round.settle()
