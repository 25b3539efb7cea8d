"""The cases of the operations that take lists: bodies of n entries, each with the map that makes it costly."""

import itertools
import json
from typing import Callable, NamedTuple

from costs_measure import ask, packed
from costs_shapes import (APART_M, SHAPES, a_class_of_its_own, detection, in_row, keyframe, observed, placed, pose, signs, words)

CASES = []


class Case(NamedTuple):
    """`run(ground, body, map, most)` builds a map and yields requests that cost alike; `most` is the largest body. `body`
    and `map` are the largest sizes, in the short form and in the long one; without one, that does not grow. `alone` asks for
    a server of its own, `model` for one with a stand-in for a model; `long` leaves it out of the short form."""

    operation: str
    shape: str
    lists: tuple
    body: tuple | None
    map: tuple | None
    run: Callable
    alone: bool = False
    long: bool = False
    model: bool = False

    @property
    def name(self):
        return f"{self.operation}: {self.shape}"


def case(operation, *lists, body=None, map=None, **more):  # noqa: A002
    """Makes a function a case of an operation; its name says the shape."""
    def add(run):
        CASES.append(Case(operation, run.__name__.replace("_", " "), lists, body, map, run, **more))
        return run
    return add


# Keyframes of each shape, to each operation that takes keyframes.

def put(path, body, turn):
    return ask("PUT", f"{path}/keyframes/asked-{turn}", body)


def put_and_query(path, body, turn):
    return ask("PUT", f"{path}/keyframes/asked-{turn}?query=loop", body)


def bulk(path, body, turn):
    return ask("POST", f"{path}/keyframes", body | {"id": f"asked-{turn}"}, kind="application/x-ndjson", statuses=(200,))


def query(path, body, turn):
    return ask("POST", f"{path}/loop-queries", {"inline": body, "seed": turn})


def query_of_another_session(path, body, turn):
    return ask("POST", f"{path}/loop-queries", {"inline": body | {"session": "another"}, "seed": turn, "verify": "geometry"})


def locate(path, body, turn):
    return ask("POST", "/v1/locate", {"keyframe": body, "maps": [path.split("/")[-1]], "seed": turn})


def locate_several(path, body, turn):
    return ask("POST", "/v1/locate", {"keyframes": [body] * 4, "maps": [path.split("/")[-1]], "seed": turn})


def of_shape(shape, operation, under, request, also="", **more):
    """A case that sends keyframes of a shape; the cases of a shape share its maps."""
    def run(ground, body, many, most):
        path = ground.once((shape.name, most, many), lambda: ground.map(shape.lines(most, many or 0), {"settings": shape.settings or {}}))
        for turn in ground.numbers:
            yield request(path, keyframe((many or 0) + 10, shape.make(body), shape.step), turn)
    lists = tuple(f"{under}{name}" for name in shape.lists)
    CASES.append(Case(operation, shape.name + also, lists, shape.body, shape.map, run, **more))


for each in SHAPES:
    of_shape(each, "query_loop", "inline.", query)
    if each.map:
        of_shape(each, "query_loop", "inline.", query_of_another_session, ", of another session")
    of_shape(each, "locate", "keyframe.", locate)
    of_shape(each, "locate", "keyframes[].", locate_several, ", four times", long=True)
    of_shape(each, "put_keyframe", "", put)
    of_shape(each, "put_keyframe", "", put_and_query, ", with its query", long=True)
    of_shape(each, "put_keyframes", "", bulk, long=True)


def neighbours(ground, many):
    """A map whose keyframes are all neighbours of each other, as their client says; none has points."""
    def lines():
        for number in range(many):
            known = [{"keyframe": f"kf-{n}", "shared": 100} for n in range(max(0, number - 10_000), number)]
            yield keyframe(number, words(50) | {"covisible": known}, APART_M, id=f"kf-{number}")
    return ground.once(("neighbours", many), lambda: ground.map(lines()))


def covisible(body):
    return {"covisible": [{"keyframe": f"kf-{n}", "shared": 100} for n in range(body)]}


def of_neighbours(operation, under, request, **more):
    def run(ground, body, many, most):
        path = neighbours(ground, max(many, most))
        for turn in ground.numbers:
            yield request(path, keyframe(2 * many + turn, words(50) | covisible(body), APART_M), turn)
    CASES.append(Case(operation, "neighbours of each other", (f"{under}covisible",), (200, 800), (400, 1_600), run, **more))


of_neighbours("query_loop", "inline.", query)
of_neighbours("locate", "keyframe.", locate)
of_neighbours("locate", "keyframes[].", locate_several)
of_neighbours("put_keyframe", "", put)
of_neighbours("put_keyframes", "", bulk)


def alone_of(shape_of):
    """Keyframes that are neighbours of no other, each of the same content."""
    return (keyframe(n, shape_of(n), APART_M, id=f"kf-{n}") for n in itertools.count())


@case("put_keyframe", "covisible", body=(2_000, 10_000), map=(2_000, 10_000))
def neighbours_that_have_no_others(ground, body, many, most):
    path = ground.once(("single", most, many), lambda: ground.map(itertools.islice(alone_of(lambda n: words(10, n)), max(many, most))))
    for turn in ground.numbers:
        yield put(path, keyframe(2 * many + turn, covisible(body), APART_M), turn)


@case("put_keyframes", body=(400, 4_000), map=(400, 4_000))
def lines_of_neighbours_in_a_row(ground, body, many, most):
    line = lambda n: keyframe(n, words(100, n) | observed(100, n * 10) | signs(2, lambda i: f"Room {n + i}", lambda i: (n * 0.5, i, 2.0)), 0.5, id=f"kf-{n}")  # noqa: E731
    path = ground.map(line(n) for n in range(many))
    for turn in itertools.count():
        raw = b"\n".join(json.dumps(line(many + turn * most + n)).encode() for n in range(body))
        yield ask("POST", f"{path}/keyframes", kind="application/x-ndjson", statuses=(200,))._replace(raw=raw)


# "Where am I?"

@case("locate", "keyframes", body=(16, 16), map=(200, 400))
def keyframes_with_signs_that_share_words(ground, body, many, most):
    shape = next(each for each in SHAPES if each.name == "signs that share all words but one")
    path = ground.once((shape.name, 20, many), lambda: ground.map(shape.lines(20, many)))
    for turn in ground.numbers:
        frames = [keyframe(i, shape.make(20)) for i in range(body)]
        yield ask("POST", "/v1/locate", {"keyframes": frames, "maps": [path.split("/")[-1]], "seed": turn})


@case("locate", "keyframes", body=(16, 16), map=(40, 200))
def keyframes_with_features(ground, body, many, most):
    shape = next(each for each in SHAPES if each.name == "features all different")
    path = ground.once((shape.name, 500, many), lambda: ground.map(shape.lines(500, many)))
    for turn in ground.numbers:
        frames = [keyframe(i, shape.make(500)) for i in range(body)]
        yield ask("POST", "/v1/locate", {"keyframes": frames, "maps": [path.split("/")[-1]], "seed": turn})


@case("locate", "maps", body=(100, 100), map=(400, 2_000))
def patterns_of_many_stars(ground, body, many, most):
    ground.once(("named", many), lambda: [ground.map(name=f"{'a' * 100}-{n}") for n in range(many)])
    for turn in ground.numbers:
        patterns = [f"{'*a' * 50}*{turn}-{n}z" for n in range(body - 1)] + [f"{'a' * 100}-0"]
        yield ask("POST", "/v1/locate", {"keyframe": words(5), "maps": patterns}, statuses=(200, 404, 422))


@case("locate", "exclude.keyframes", body=(10_000, 10_000), map=(400, 4_000))
def keyframes_left_out(ground, body, many, most):
    path = ground.once(("alike", many), lambda: ground.map(itertools.islice(alone_of(lambda n: words(100)), many)))
    for turn in ground.numbers:
        yield ask("POST", "/v1/locate", {"keyframe": words(100), "maps": [path.split("/")[-1]], "seed": turn,
                                         "exclude": {"keyframes": [f"kf-{n}" for n in range(body)]}})


@case("locate", "exclude.sessions", body=(10_000, 10_000), map=(400, 4_000))
def sessions_left_out(ground, body, many, most):
    path = ground.once(("alike", many), lambda: ground.map(itertools.islice(alone_of(lambda n: words(100)), many)))
    for turn in ground.numbers:
        yield ask("POST", "/v1/locate", {"keyframe": words(100), "maps": [path.split("/")[-1]], "seed": turn,
                                         "exclude": {"sessions": ["default"] + [f"s-{n}" for n in range(body - 1)]}})


# Changed observations.

def seen_by_all(ground, points, keyframes, content=observed):
    return ground.map(keyframe(n, content(points), id=f"kf-{n}") for n in range(keyframes))


@case("change_observations", "replaced", body=(400, 500), map=(160, 400))
def points_fused_that_every_keyframe_sees(ground, body, many, most):
    while True:
        path = seen_by_all(ground, most, many)
        yield ask("POST", f"{path}/observations", {"replaced": [[n, 100_000 + n] for n in range(body)]})


@case("change_observations", "replaced", body=(400, 2_000), map=(100, 300))
def points_fused_into_one_that_every_keyframe_sees(ground, body, many, most):
    while True:
        path = seen_by_all(ground, most, many)
        yield ask("POST", f"{path}/observations", {"replaced": [[n, most + 1] for n in range(body)]})


@case("change_observations", "replaced", body=(2_000, 10_000))
def points_fused_one_after_another(ground, body, many, most):
    while True:
        path = seen_by_all(ground, most, 10)
        yield ask("POST", f"{path}/observations", {"replaced": [[n, n + 1] for n in range(body)]}, statuses=(200, 422))


@case("change_observations", "replaced", body=(400, 2_000), map=(100, 400))
def points_fused_that_many_anchors_have(ground, body, many, most):
    while True:
        path = ground.map(keyframe(i, a_class_of_its_own(most, i), id=f"kf-{i}") for i in range(many))
        yield ask("POST", f"{path}/observations", {"replaced": [[n, 100_000 + n] for n in range(body)]})


@case("change_observations", "removed", body=(400, 500), map=(160, 400))
def points_culled_that_every_keyframe_sees(ground, body, many, most):
    while True:
        path = seen_by_all(ground, most, many)
        yield ask("POST", f"{path}/observations", {"removed": list(range(body))})


@case("change_observations", "removed", body=(400, 2_000), map=(100, 400))
def points_culled_that_many_anchors_have(ground, body, many, most):
    while True:
        path = ground.map(keyframe(i, a_class_of_its_own(most, i), id=f"kf-{i}") for i in range(many))
        yield ask("POST", f"{path}/observations", {"removed": list(range(body))})


@case("change_observations", "keyframes", body=(100, 800), map=(100, 800))
def keyframes_that_all_see_other_points(ground, body, many, most):
    path = seen_by_all(ground, 200, max(many, most))
    for turn in itertools.count(1):
        changed = [{"keyframe": f"kf-{n}", "observes_i64": packed(range(turn * 100, turn * 100 + 200), "q")} for n in range(body)]
        yield ask("POST", f"{path}/observations", {"keyframes": changed})
        if body < max(many, most):
            path = seen_by_all(ground, 200, max(many, most))


@case("change_observations", "keyframes[].observes_i64", body=(1_000, 4_000), map=(200, 600))
def a_keyframe_that_sees_what_every_keyframe_sees(ground, body, many, most):
    path = seen_by_all(ground, most, many)
    for turn in itertools.count(1):
        yield ask("POST", f"{path}/observations", {"keyframes": [{"keyframe": "kf-0", "observes_i64": packed(range(turn, turn + body), "q")}]})


@case("change_observations", "keyframes[].observes", body=(100_000, 100_000))
def a_keyframe_that_sees_many_points(ground, body, many, most):
    path = seen_by_all(ground, 10, 10)
    for turn in itertools.count(1):
        yield ask("POST", f"{path}/observations", {"keyframes": [{"keyframe": "kf-0", "observes": list(range(turn * 100_000, turn * 100_000 + body))}]})


@case("change_observations", "keyframes[].covisible", body=(2_000, 10_000), map=(2_000, 10_000))
def neighbours_found_later(ground, body, many, most):
    path = ground.map(itertools.islice(alone_of(lambda n: words(10, n)), max(many, most) + 1))
    for turn in itertools.count(1):
        known = [{"keyframe": f"kf-{n + 1}", "shared": turn} for n in range(body)]
        yield ask("POST", f"{path}/observations", {"keyframes": [{"keyframe": "kf-0", "covisible": known}]})


@case("change_observations", "keyframes", "keyframes[].covisible", body=(100, 1_000))
def keyframes_that_become_neighbours_of_one_another(ground, body, many, most):
    while True:
        path = ground.map(itertools.islice(alone_of(lambda n: words(10, n)), most))
        changed = [{"keyframe": f"kf-{n}", "covisible": [{"keyframe": f"kf-{(n + i) % body}", "shared": 9} for i in range(1, 20)]} for n in range(body)]
        yield ask("POST", f"{path}/observations", {"keyframes": changed})


# Corrected poses.

@case("correct_poses", "keyframes.ids", "keyframes.poses", body=(4_000, 100_000), map=(4_000, 100_000))
def poses_of_keyframes(ground, body, many, most):
    path = ground.map(itertools.islice(alone_of(lambda n: words(1, n)), max(many, most)))
    for turn in itertools.count(1):
        yield ask("POST", f"{path}/poses", {"keyframes": {"ids": [f"kf-{n}" for n in range(body)], "poses": [pose(n * APART_M, turn) for n in range(body)]}})


@case("correct_poses", "keyframes.ids", "keyframes.poses", body=(100, 400), map=(100, 400))
def poses_of_keyframes_that_see_the_same_signs(ground, body, many, most):
    path = ground.map(keyframe(n, signs(20, lambda i: f"Room {i}", in_row), id=f"kf-{n}") for n in range(max(many, most)))
    for turn in itertools.count(1):
        yield ask("POST", f"{path}/poses", {"keyframes": {"ids": [f"kf-{n}" for n in range(body)], "poses": [pose(n * 0.01, turn) for n in range(body)]}})


@case("correct_poses", "map_points.ids_i64", "map_points.positions_f64", body=(1_000, 4_000), map=(200, 600))
def places_of_points_that_every_keyframe_sees(ground, body, many, most):
    path = seen_by_all(ground, most, many, lambda n: observed(n) | placed(n))
    for turn in itertools.count(1):
        yield ask("POST", f"{path}/poses", {"map_points": {"ids_i64": packed(range(body), "q"), "positions_f64": packed([float(turn)] * (3 * body), "d")}})


@case("correct_poses", "map_points.ids", "map_points.positions", body=(400, 2_000), map=(100, 400))
def places_of_points_that_many_anchors_have(ground, body, many, most):
    path = ground.map(keyframe(i, a_class_of_its_own(most, i), id=f"kf-{i}") for i in range(many))
    for turn in itertools.count(1):
        yield ask("POST", f"{path}/poses", {"map_points": {"ids": list(range(body)), "positions": [[turn, 0, 0]] * body}})


@case("correct_poses", "map_points.ids", "map_points.positions", body=(40_000, 100_000))
def places_as_lists(ground, body, many, most):
    path = seen_by_all(ground, 100_000, 1, placed)
    for turn in itertools.count(1):
        yield ask("POST", f"{path}/poses", {"map_points": {"ids": list(range(body)), "positions": [[turn, 0, 0]] * body}})


# Sessions.

@case("merge_sessions", "map_points.ids", body=(4_000, 100_000), map=(100, 400))
def points_that_get_other_numbers(ground, body, many, most):
    while True:
        path = ground.map(keyframe(n, observed(most if n == 0 else 100) | {"session": "a" if n % 2 else "b"}, id=f"kf-{n}") for n in range(many))
        yield ask("POST", f"{path}/sessions/b/merge", {"into": "a", "into_from_session": pose(1.0), "map_points": {"ids": [[n, 200_000 + n] for n in range(body)]}})


@case("merge_sessions", map=(100, 1_000))
def keyframes_that_see_the_same_points_and_signs(ground, body, many, most):
    while True:
        path = ground.map(keyframe(n, placed(200) | signs(5, lambda i: f"Room {i}", in_row) | {"session": "a" if n % 2 else "b"}, id=f"kf-{n}") for n in range(many))
        yield ask("POST", f"{path}/sessions/b/merge", {"into": "a", "into_from_session": pose(0.1)})


@case("merge_sessions", map=(40, 400))
def a_session_after_many_others(ground, body, many, most):
    path = ground.map(keyframe(n, observed(100, n) | {"session": f"s-{n}"}, id=f"kf-{n}") for n in range(many))
    for n in range(many - 4):
        ground.do("POST", f"{path}/sessions/s-{n}/merge", {"into": f"s-{n + 1}", "into_from_session": pose(0.1)})
    for n in range(many - 4, many - 1):
        yield ask("POST", f"{path}/sessions/s-{n}/merge", {"into": f"s-{n + 1}", "into_from_session": pose(0.1)})


@case("revoke_merge", map=(100, 1_000))
def a_session_of_many_keyframes(ground, body, many, most):
    path = ground.map(keyframe(n, placed(200) | {"session": "a" if n % 2 else "b"}, id=f"kf-{n}") for n in range(many))
    while True:
        ground.do("POST", f"{path}/sessions/b/merge", {"into": "a", "into_from_session": pose(0.1)})
        yield ask("DELETE", f"{path}/sessions/b/merge")


# Settings.

def many_texts(ground, many, each=20):
    """A map of so many anchors, of many classes, each with a text of its own."""
    text = lambda k: lambda i: f"{['Room', 'Saal'][i % 2]} {each * k + i}"  # noqa: E731
    kind = lambda k: lambda i: f"class-{(each * k + i) % 256}"  # noqa: E731
    return ground.map(keyframe(k, signs(each, text(k), lambda i: in_row(i, k), kind(k)), id=f"kf-{k}") for k in range(max(1, many // each)))


def patterns(n, turn):
    return [f"((room|saal)+ *)*{turn}[0-9]{{1,{i + 1}}}" for i in range(n)]


@case("put_map", "settings.identifier_patterns", body=(16, 16))
def a_map_with_patterns(ground, body, many, most):
    for turn in ground.numbers:
        yield ask("PUT", f"/v1/maps/m-{turn}", {"settings": {"identifier_patterns": patterns(body, turn)}})


@case("put_map", "settings.identifier_patterns", body=(16, 16))
def a_map_with_patterns_that_repeat(ground, body, many, most):
    for turn in ground.numbers:
        yield ask("PUT", f"/v1/maps/m-{turn}", {"settings": {"identifier_patterns": [f"((a{{0,9}}){{0,9}}){{0,9}}b{turn + i}" for i in range(body)]}}, statuses=(200, 201, 422))


@case("put_map", "anchor_classes", "code_classes", body=(256, 256))
def a_map_with_classes(ground, body, many, most):
    for turn in ground.numbers:
        yield ask("PUT", f"/v1/maps/m-{turn}", {"anchor_classes": [f"class-{n}" for n in range(body)], "code_classes": [f"class-{n}" for n in range(body)]})


@case("put_map", map=(100, 1_000))
def a_copy_of_a_map(ground, body, many, most):
    path = ground.map(keyframe(n, words(200, n) | placed(100), id=f"kf-{n}") for n in range(many))
    for turn in ground.numbers:
        yield ask("PUT", f"/v1/maps/m-{turn}", {"base": {"map": path.split("/")[-1]}})


@case("patch_map", "settings.identifier_patterns", body=(16, 16), map=(2_000, 16_000))
def patterns_over_many_texts(ground, body, many, most):
    path = ground.once(("texts", many), lambda: many_texts(ground, many))
    for turn in ground.numbers:
        yield ask("PATCH", path, {"settings": {"identifier_patterns": patterns(body, turn)}})


@case("patch_map", "code_classes", body=(256, 256), map=(2_000, 16_000))
def classes_of_many_texts_become_codes(ground, body, many, most):
    path = many_texts(ground, many)
    for turn in itertools.count(1):
        yield ask("PATCH", path, {"code_classes": [f"class-{n}" for n in range(body)] if turn % 2 else [f"other-{n}" for n in range(body)]})


@case("patch_map", "anchor_classes", body=(256, 256), map=(2_000, 16_000))
def classes_of_anchors(ground, body, many, most):
    path = ground.once(("texts", many), lambda: many_texts(ground, many))
    for turn in ground.numbers:
        yield ask("PATCH", path, {"anchor_classes": [f"class-{n + turn}" for n in range(body)]})


def setting(name, *values):
    """Changes one setting of a map of many texts to and fro."""
    def run(ground, body, many, most):
        path = many_texts(ground, many)
        for value in itertools.cycle(values):
            yield ask("PATCH", path, {"settings": {name: value}})
    CASES.append(Case("patch_map", f"{name} over many texts", (), None, (2_000, 16_000), run))


setting("matching_min_similarity_level", 2, 4)
setting("learned_identifiers", False, True)
setting("description_min_information_level", 1, 5)
setting("reading_min_confidence", 0.95, 0.5)
setting("covisibility_min_shared_points", 3, 15)


@case("patch_map", map=(100, 800))
def the_least_of_shared_points_where_every_keyframe_sees_all(ground, body, many, most):
    path = seen_by_all(ground, 200, many)
    for least in itertools.cycle((201, 15)):
        yield ask("PATCH", path, {"settings": {"covisibility_min_shared_points": least}})


# Erasures write the file of the database anew.

@case("erase", "keyframes", body=(200, 10_000), map=(200, 10_000), alone=True)
def keyframes_by_id(ground, body, many, most):
    path = ground.map(keyframe(n, words(50, n) | observed(50, n), id=f"kf-{n}") for n in range(max(many, most)))
    yield ask("POST", f"{path}/erase", {"keyframes": [f"kf-{n}" for n in range(body)]}, job=True)


@case("erase", "sessions", body=(100, 1_000), map=(100, 1_000), alone=True)
def sessions_of_a_keyframe_each(ground, body, many, most):
    path = ground.map(keyframe(n, words(50, n) | {"session": f"s-{n}"}, id=f"kf-{n}") for n in range(max(many, most)))
    yield ask("POST", f"{path}/erase", {"sessions": [f"s-{n}" for n in range(body)]}, job=True)


@case("erase", "sessions", map=(60, 300), alone=True)
def a_session_of_many_that_merged_one_into_the_next(ground, body, many, most):
    path = ground.map(keyframe(n, observed(50, n) | {"session": f"s-{n}"}, id=f"kf-{n}") for n in range(many))
    for n in range(many - 1):
        ground.do("POST", f"{path}/sessions/s-{n}/merge", {"into": f"s-{n + 1}", "into_from_session": pose(0.1)})
    yield ask("POST", f"{path}/erase", {"sessions": [f"s-{many - 1}"]}, job=True)


# Verdicts of models.

@case("bring_model_verdict", map=(400, 4_000))
def of_two_texts_that_many_anchors_have(ground, body, many, most):
    text = lambda k: lambda i: f"{['kitchen', 'pantry'][i % 2]} of the house"  # noqa: E731
    path = ground.map(keyframe(k, signs(20, text(k), lambda i: in_row(i, k)), id=f"kf-{k}") for k in range(max(1, many // 20)))
    for turn in itertools.count():
        yield ask("POST", f"{path}/model-verdicts", {"operation": "similarity", "class": "sign", "texts": ["kitchen of the house", "pantry of the house"],
                                                     "level": 5 if turn % 2 == 0 else 1, "source": f"model:m-{turn}"})


# Keys: each request looks at them, and at their patterns.

def with_keys(ground, keys, maps_of=lambda n: ["*"]):
    """Makes keys, after the administrator's; their headers."""
    ground.administer()
    made = [ground.do("POST", "/v1/keys", {"name": f"k-{n}", "actions": ["read", "write", "query"], "maps": maps_of(n)}, statuses=(201,)) for n in range(keys)]
    return [((("authorization", f"Bearer {key['secret']}"),)) for key in made], made


@case("create_key", "maps", body=(100, 100), map=(100, 1_000), alone=True)
def a_key_of_many_patterns(ground, body, many, most):
    with_keys(ground, many)
    for turn in itertools.count():
        yield ask("POST", "/v1/keys", {"name": f"new-{turn}", "actions": ["read"], "maps": [f"{'*a' * 60}-{n}" for n in range(body)]}, headers=ground.headers)


@case("list_keys", map=(100, 1_000), alone=True)
def a_page_of_many_keys(ground, body, many, most):
    with_keys(ground, many, lambda n: [f"{'a' * 100}{i}" for i in range(20)])
    while True:
        yield ask("GET", "/v1/keys?limit=50", headers=ground.headers)


@case("get_own_key", map=(100, 1_000), alone=True)
def one_of_many_keys(ground, body, many, most):
    headers, _ = with_keys(ground, many)
    while True:
        yield ask("GET", "/v1/keys/me", headers=headers[-1])


@case("revoke_key", map=(100, 1_000), alone=True)
def another_of_many_keys(ground, body, many, most):
    _, keys = with_keys(ground, many)
    for key in reversed(keys):
        yield ask("DELETE", f"/v1/keys/{key['id']}", headers=ground.headers)


@case("list_maps", map=(200, 2_000), alone=True)
def maps_that_patterns_of_a_key_hardly_miss(ground, body, many, most):
    headers, _ = with_keys(ground, 1, lambda n: [f"{'*a' * 50}*{i}z" for i in range(100)])
    for n in range(many):
        ground.map(name=f"{'a' * 100}-{n}")
    while True:
        yield ask("GET", "/v1/maps?limit=100", headers=headers[0])
