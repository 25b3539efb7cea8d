"""The cases of the operations without lists: what they cost in maps of n things, or with texts of n characters."""

import itertools

from costs_cases import CASES, Case, alone_of, case, many_texts, neighbours, seen_by_all
from costs_measure import ask, encoded
from costs_shapes import APART_M, detection, in_row, keyframe, observed, placed, pose, shuffled, signs, words

# So many poses at once wait for their rows.
CORRECTED = 400
GIF_LIKE = b"\x89PNG\r\n\x1a\n" + bytes(1_000)
EXIT = lambda i: "EXIT"  # noqa: E731


def reads(operation, shape, path, build, sizes, **more):
    """A case that asks for one path under a map, again and again. Cases with the same `build` share their maps."""
    def run(ground, body, many, most):
        base = ground.once((build.__name__, many), lambda: build(ground, many))
        while True:
            yield ask("GET", f"{base}{path(many)}")
    CASES.append(Case(operation, shape, (), None, sizes, run, **more))


def server(operation, path):
    """A case of an operation that is asked of the server, not of a map: on one of many maps."""
    @case(operation, map=(200, 2_000))
    def many_maps(ground, body, many, most):
        ground.once(("maps", many), lambda: [ground.map() for _ in range(many)])
        while True:
            yield ask("GET", path)


for asked, where in (("healthz", "/healthz"), ("readyz", "/readyz"), ("get_metrics", "/metrics"), ("get_document", "/openapi.json"), ("get_version", "/version"),
                     ("get_usage", "/v1/usage"), ("list_maps", "/v1/maps?limit=100")):
    server(asked, where)


# Maps of one kind of thing.

def of_keyframes(ground, many):
    return ground.map(keyframe(n, words(50, n) | observed(60, 20 * n) | signs(1, lambda i: f"Room {n}", lambda i: (n * 0.5, 1.0, 2.0)), 0.5, id=f"kf-{n}") for n in range(many))


def of_texts(ground, many):
    return many_texts(ground, many)


def of_one_sign(ground, many):
    """One sign that every keyframe saw, and read otherwise."""
    path = ground.map(keyframe(n, signs(1, lambda i: f"Room {n}"), id=f"kf-{n}") for n in range(many))
    return path


def of_equal_signs(ground, many):
    """As many signs that all say EXIT."""
    return ground.map(keyframe(k, signs(20, EXIT, lambda i: in_row(i, k)), APART_M, id=f"kf-{k}") for k in range(max(1, many // 20)))


def of_sessions(ground, many):
    """Sessions of one keyframe that see the same plan's signs; each could lie anywhere."""
    path = ground.map()
    for n in range(12):
        ground.do("PUT", f"{path}/anchors/p-{n}", {"class": "sign", "description": f"Room {n}", "position": [2.0 * n, n % 3, 1.0], "frame": "plan"})
    ground.add(path, (keyframe(s, signs(6, lambda i: f"Room {i}", in_row) | {"session": f"s-{s}"}, id=f"kf-{s}") for s in range(many)))
    return path


def of_loops(ground, many):
    """A session to each keyframe, each joined to the one before and to the first."""
    path = ground.map(keyframe(n, words(20) | {"session": f"s-{n}"}, id=f"kf-{n}") for n in range(many))
    for n in range(1, many):
        ground.do("POST", f"{path}/loops", {"id": f"row-{n}", "keyframe": f"kf-{n}", "candidate": f"kf-{n - 1}", "candidate_from_query": pose(1.0)}, statuses=(201,))
    for n in range(2, many):
        ground.do("POST", f"{path}/loops", {"id": f"star-{n}", "keyframe": f"kf-{n}", "candidate": "kf-0", "candidate_from_query": pose(float(n))}, statuses=(201,))
    return path


def of_queries(ground, many):
    path = ground.map(itertools.islice(alone_of(lambda n: words(20)), 40))
    for n in range(many):
        ground.do("POST", f"{path}/loop-queries", {"keyframe": f"kf-{n % 40}", "seed": n})
    return path


def of_neighbours(ground, many):
    return neighbours(ground, many)


def of_shared_points(ground, many):
    return seen_by_all(ground, 200, many, placed)


def of_neighbours_with_signs(ground, many):
    """Keyframes that see the same points, and twenty signs each of their own."""
    return ground.map(keyframe(k, observed(100) | signs(20, lambda i: f"Room {20 * k + i}", lambda i: in_row(i, k)), id=f"kf-{k}") for k in range(many))


def of_releases(ground, many):
    path = ground.map(keyframe(n, words(20, n), id=f"kf-{n}") for n in range(5))
    for n in range(min(many, 60)):
        ground.do("PUT", f"{path}/releases/r-{n}", {})
    return path


def of_a_changed_release(ground, many):
    """A release, after which as many keyframes with signs came."""
    path = ground.map()
    ground.do("PUT", f"{path}/releases/r-0", {})
    ground.add(path, (keyframe(n, signs(2, lambda i: f"Room {2 * n + i}", lambda i: in_row(i, n)), APART_M, id=f"kf-{n}") for n in range(many)))
    return path


def of_crops(ground, many):
    """One sign with a crop in every keyframe."""
    return ground.map(keyframe(n, {"detections": [detection("EXIT", crop=encoded(GIF_LIKE))]}, id=f"kf-{n}") for n in range(many))


def of_corrections(ground, many):
    """Keyframes with signs, whose poses are corrected again and again, so many at once that they reach their rows later."""
    path, poses = ground.map(keyframe(k, signs(5, EXIT, lambda i: in_row(i, k)), APART_M, id=f"kf-{k}") for k in range(CORRECTED)), range(CORRECTED)
    for n in range(many):
        ground.do("POST", f"{path}/poses", {"keyframes": {"ids": [f"kf-{k}" for k in poses], "poses": [pose(k * APART_M, 0.001 * n) for k in poses]}})
    return path


def constant(path):
    return lambda many: path


reads("get_map", "keyframes in a row", constant(""), of_keyframes, (400, 8_000))
reads("get_map", "many texts", constant(""), of_texts, (2_000, 16_000))
reads("get_map", "many sessions", constant(""), of_sessions, (100, 1_000))
reads("list_keyframes", "a page of keyframes in a row", constant("/keyframes?limit=100"), of_keyframes, (400, 8_000))
reads("list_keyframes", "those that may go, where every keyframe sees all", constant("/keyframes?redundant=true&limit=100"), of_shared_points, (200, 1_600))
reads("list_keyframes", "those that may go, in a row", constant("/keyframes?redundant=true&limit=100"), of_keyframes, (400, 8_000))
reads("get_keyframe", "keyframes in a row", constant("/keyframes/kf-0"), of_keyframes, (400, 8_000))
reads("get_keyframe", "points that every keyframe sees", constant("/keyframes/kf-0"), of_shared_points, (200, 1_600))
reads("list_covisible", "neighbours of each other", constant("/keyframes/kf-0/covisible"), of_neighbours, (400, 2_000))
reads("list_covisible", "points that every keyframe sees", constant("/keyframes/kf-0/covisible"), of_shared_points, (200, 1_600))
reads("get_local_anchor_map", "neighbours with signs of their own", constant("/keyframes/kf-0/local-anchor-map"), of_neighbours_with_signs, (100, 400))
reads("list_anchors", "a page of many texts", constant("/anchors?limit=100"), of_texts, (2_000, 16_000))
reads("list_anchors", "words that no text has", constant("/anchors?limit=100&text=room%20nowhere"), of_texts, (2_000, 16_000))
reads("list_anchors", "words that every text has", constant("/anchors?limit=100&text=room"), of_texts, (2_000, 16_000))
reads("list_anchors", "a class that no anchor has", constant("/anchors?limit=100&class=other"), of_texts, (2_000, 16_000))
reads("list_anchors", "signs that all say EXIT", constant("/anchors?limit=100"), of_equal_signs, (1_000, 16_000))
reads("list_loops", "a page", constant("/loops?limit=100"), of_loops, (100, 600))
reads("get_frames", "sessions in a row, each joined to the first, too", constant("/frames"), of_loops, (100, 600))
reads("get_trajectory", "keyframes in a row", constant("/trajectory?format=g2o"), of_keyframes, (400, 8_000))
reads("get_trajectory", "sessions in one frame", constant("/trajectory?format=g2o&frame=fleet"), of_loops, (100, 600))
reads("list_loop_queries", "a page", constant("/loop-queries?limit=100"), of_queries, (200, 2_000))
reads("list_loop_queries", "a session that nothing was asked of", constant("/loop-queries?limit=100&session=none"), of_queries, (200, 2_000))
reads("list_sessions", "a page of sessions that could lie anywhere in a plan", constant("/sessions?limit=50"), of_sessions, (100, 1_000))
reads("list_releases", "a page", constant("/releases?limit=10"), of_releases, (60, 60))
reads("get_release", "one of many", constant("/releases/r-0"), of_releases, (60, 60))
reads("get_changes", "a page of a map that changed", constant("/changes?since=r-0&limit=100"), of_a_changed_release, (400, 8_000))
reads("export_map", "keyframes in a row", constant("/export"), of_keyframes, (400, 8_000))
reads("export_map", "poses corrected again and again", constant("/export"), of_corrections, (40, 200))


def first_anchor(ground, path):
    """The id of a map's oldest anchor."""
    return ground.do("GET", f"{path}/anchors?limit=1")["items"][0]["id"]


def of_anchor(operation, shape, build, sizes, request, **more):
    """A case about the oldest anchor of a map; what is written to it is another thing each time."""
    def run(ground, body, many, most):
        path = ground.once((build.__name__, many), lambda: build(ground, many))
        anchor = first_anchor(ground, path)
        for turn in ground.numbers:
            yield request(f"{path}/anchors/{anchor}", turn)
    CASES.append(Case(operation, shape, (), None, sizes, run, **more))


def described(text):
    return lambda path, turn: ask("PATCH", path, {"description": text(turn)}, headers=(("if-match", "*"),))


of_anchor("get_anchor", "signs that all say EXIT", of_equal_signs, (1_000, 16_000), lambda path, turn: ask("GET", path))
of_anchor("get_anchor", "a sign that every keyframe saw", of_one_sign, (400, 1_600), lambda path, turn: ask("GET", path))
of_anchor("get_crop", "a sign with a crop in every keyframe", of_crops, (200, 2_000), lambda path, turn: ask("GET", f"{path}/crop"))
of_anchor("get_transcript", "a sign with a crop in every keyframe", of_crops, (200, 2_000), lambda path, turn: ask("GET", f"{path}/transcript"))
of_anchor("patch_anchor", "signs that all say EXIT", of_equal_signs, (1_000, 16_000), described(lambda turn: "EXIT" if turn % 2 else "Exit door"))
of_anchor("patch_anchor", "a sign that every keyframe saw", of_one_sign, (400, 1_600), described(lambda turn: f"Room {turn}"))
of_anchor("patch_anchor", "many texts", of_texts, (2_000, 16_000), described(lambda turn: f"Room {turn}"))


def of_words(ground, many):
    """As many texts of the same words, in another order each."""
    return ground.map(keyframe(k, signs(20, lambda i: shuffled(20 * k + i), lambda i: in_row(i, k)), APART_M, id=f"kf-{k}") for k in range(max(1, many // 20)))


of_anchor("patch_anchor", "texts of the same words in another order", of_words, (1_000, 16_000), described(lambda turn: shuffled(1_000_000 + turn)))


@case("put_keyframe", map=(400, 1_600))
def one_more_that_reads_a_sign_otherwise_than_every_keyframe(ground, body, many, most):
    path = ground.once(("of_one_sign", many), lambda: of_one_sign(ground, many))
    for n in ground.numbers:
        yield ask("PUT", f"{path}/keyframes/more-{n}", keyframe(many, signs(1, lambda i: f"Saal {n}")))


@case("delete_anchor", map=(400, 1_600))
def a_sign_that_every_keyframe_saw(ground, body, many, most):
    while True:
        path = of_one_sign(ground, many)
        yield ask("DELETE", f"{path}/anchors/{first_anchor(ground, path)}")


@case("delete_anchor", map=(1_000, 16_000))
def signs_that_all_say_exit(ground, body, many, most):
    path = of_equal_signs(ground, many)
    while True:
        yield ask("DELETE", f"{path}/anchors/{first_anchor(ground, path)}")


@case("put_prior_anchor", map=(200, 2_000))
def signs_of_a_plan_that_all_say_exit(ground, body, many, most):
    path = ground.map()
    prior = lambda n: ask("PUT", f"{path}/anchors/p-{n}", {"class": "sign", "description": "EXIT", "position": [n, 0, 1], "frame": "plan"})  # noqa: E731
    for n in range(many):
        prior(n).send(ground.client)
    for n in itertools.count(many):
        yield prior(n)


@case("put_prior_anchor", map=(40, 400))
def a_plan_that_many_sessions_may_lie_in(ground, body, many, most):
    path = ground.once(("of_sessions", many), lambda: of_sessions(ground, many))
    for n in ground.numbers:
        yield ask("PUT", f"{path}/anchors/new-{n}", {"class": "sign", "description": f"Room {n % 6}", "position": [n, 5, 1], "frame": "plan"})


@case("delete_keyframe", map=(100, 1_000))
def one_of_those_that_see_the_same_points_and_signs(ground, body, many, most):
    path = ground.map(keyframe(n, placed(200) | signs(20, lambda i: f"Room {i}", in_row), id=f"kf-{n}") for n in range(many))
    for n in range(many):
        yield ask("DELETE", f"{path}/keyframes/kf-{n}")


@case("delete_keyframe", map=(400, 2_000))
def one_of_neighbours_of_each_other(ground, body, many, most):
    path = ground.once(("of_neighbours_to_go", many), lambda: neighbours(ground, many))
    for n in range(many - 5, 0, -1):
        if ground.client.ask("GET", f"{path}/keyframes/kf-{n}").status == 200:
            yield ask("DELETE", f"{path}/keyframes/kf-{n}")


@case("delete_map", map=(400, 8_000))
def a_map_of_keyframes_in_a_row(ground, body, many, most):
    while True:
        yield ask("DELETE", of_keyframes(ground, many))


def stored_queries(ground, path):
    """A question about a stored keyframe again and again, each with a seed of its own."""
    for turn in ground.numbers:
        yield ask("POST", f"{path}/loop-queries", {"keyframe": "kf-0", "seed": turn})


@case("query_loop", map=(400, 8_000))
def a_stored_keyframe_in_a_row(ground, body, many, most):
    path = ground.once(("of_keyframes", many), lambda: of_keyframes(ground, many))
    yield from stored_queries(ground, path)


@case("query_loop", map=(100, 400))
def a_stored_keyframe_whose_neighbours_have_signs_of_their_own(ground, body, many, most):
    path = ground.once(("of_neighbours_with_signs", many), lambda: of_neighbours_with_signs(ground, many))
    yield from stored_queries(ground, path)


@case("query_loop", map=(200, 1_000))
def as_many_candidates_as_there_may_be(ground, body, many, most):
    build = lambda: ground.map((keyframe(n, words(200) | signs(5, lambda i: f"Room {i}", in_row), APART_M, id=f"kf-{n}") for n in range(many)), {"settings": {"candidates_max": 1000}})  # noqa: E731
    path = ground.once(("most candidates", many), build)
    yield from stored_queries(ground, path)


@case("query_loop", map=(100, 600))
def a_stored_keyframe_that_many_loops_end_at(ground, body, many, most):
    path = ground.once(("of_loops", many), lambda: of_loops(ground, many))
    yield from stored_queries(ground, path)


@case("get_loop_query", map=(200, 2_000))
def one_of_many(ground, body, many, most):
    path = ground.once(("of_queries", many), lambda: of_queries(ground, many))
    asked = ground.do("POST", f"{path}/loop-queries", {"keyframe": "kf-0", "seed": 0})["id"]
    ground.rest()
    while True:
        yield ask("GET", f"{path}/loop-queries/{asked}")


@case("confirm_loop", map=(100, 600))
def one_more_between_many_sessions(ground, body, many, most):
    path = ground.once(("of_loops", many), lambda: of_loops(ground, many))
    for n in ground.numbers:
        yield ask("POST", f"{path}/loops", {"id": f"new-{n}", "keyframe": f"kf-{n % (many - 9) + 7}", "candidate": f"kf-{n % 5}", "candidate_from_query": pose(1.0)})


def two_passages(ground, many, text=lambda i: f"Room {i}"):
    """Two passages of so many neighbours, of which each sees twenty signs of its own; the other passage reads the same."""
    def lines(session, start):
        for k in range(many // 2):
            yield keyframe(start + k, observed(100) | {"session": session} | signs(20, lambda i: text(20 * k + i), lambda i: in_row(i, k)), id=f"{session}-{k}")
    return ground.map(itertools.chain(lines("a", 0), lines("b", 100_000)))


@case("confirm_loop", map=(20, 100))
def passages_that_read_the_same(ground, body, many, most):
    while True:
        yield ask("POST", f"{two_passages(ground, many)}/loops", {"id": "loop", "keyframe": "b-0", "candidate": "a-0", "candidate_from_query": pose()})


@case("confirm_loop", map=(20, 100))
def passages_that_all_read_exit(ground, body, many, most):
    while True:
        yield ask("POST", f"{two_passages(ground, many, EXIT)}/loops", {"id": "loop", "keyframe": "b-0", "candidate": "a-0", "candidate_from_query": pose()})


@case("revoke_loop", map=(20, 100))
def passages_that_read_the_same_again(ground, body, many, most):
    path = two_passages(ground, many)
    while True:
        ground.do("POST", f"{path}/loops", {"id": f"loop-{next(ground.numbers)}", "keyframe": "b-0", "candidate": "a-0", "candidate_from_query": pose()})
        yield ask("DELETE", f"{path}/loops/{ground.do('GET', f'{path}/loops')['items'][0]['id']}")


@case("revoke_loop", map=(100, 600))
def one_of_many_between_many_sessions(ground, body, many, most):
    path = of_loops(ground, many)
    for n in range(2, many):
        yield ask("DELETE", f"{path}/loops/star-{n}")


@case("listen", map=(400, 4_000))
def from_the_first_event_on(ground, body, many, most):
    path = ground.map()
    for n in range(many):
        ground.do("PUT", f"{path}/keyframes/kf-{n}", keyframe(n, signs(1, lambda i: f"Room {n}", lambda i: in_row(n)), APART_M))
    while True:
        yield ask("GET", f"{path}/events?since=0", stream=True)


@case("publish_release", map=(400, 8_000))
def keyframes_in_a_row(ground, body, many, most):
    path = ground.once(("of_keyframes", many), lambda: of_keyframes(ground, many))
    for n in ground.numbers:
        yield ask("PUT", f"{path}/releases/r-{n}", {})


@case("delete_release", map=(400, 8_000))
def a_release_of_keyframes_in_a_row(ground, body, many, most):
    path = ground.once(("of_keyframes", many), lambda: of_keyframes(ground, many))
    for n in ground.numbers:
        ground.do("PUT", f"{path}/releases/gone-{n}", {})
        yield ask("DELETE", f"{path}/releases/gone-{n}")


def judged(ground, many):
    """A map whose texts a model compared, and a job that asks it anew."""
    path = ground.map(keyframe(k, signs(20, lambda i: f"{shuffled(20 * k + i)}", lambda i: in_row(i, k)), APART_M, id=f"kf-{k}") for k in range(max(1, many // 20)))
    ground.rest()
    return path


@case("judge_again", map=(80, 400), model=True)
def what_a_model_said_of_many_texts(ground, body, many, most):
    path = judged(ground, many)
    while True:
        yield ask("POST", f"{path}/judgements", {"preview": True})


@case("get_judgement", map=(80, 400), model=True)
def a_job_about_many_texts(ground, body, many, most):
    path = judged(ground, many)
    ground.do("POST", f"{path}/judgements", {"id": "job"})
    ground.rest()
    while True:
        yield ask("GET", f"{path}/judgements/job")


@case("stop_judgement", map=(80, 400), model=True)
def a_running_job_about_many_texts(ground, body, many, most):
    path = judged(ground, many)
    for n in itertools.count():
        ground.do("POST", f"{path}/judgements", {"id": f"job-{n}"})
        yield ask("DELETE", f"{path}/judgements/job-{n}")


@case("take_backup", map=(400, 8_000), alone=True)
def of_keyframes_in_a_row(ground, body, many, most):
    of_keyframes(ground, many)
    for n in itertools.count():
        yield ask("POST", "/v1/backups", {"id": f"b-{n}"})


@case("list_backups", map=(20, 100), alone=True)
def a_page_of_many(ground, body, many, most):
    for n in range(many):
        ground.do("POST", "/v1/backups", {"id": f"b-{n}"})
    while True:
        yield ask("GET", "/v1/backups?limit=5")


@case("delete_backup", map=(20, 100), alone=True)
def one_of_many_backups(ground, body, many, most):
    for n in range(many):
        ground.do("POST", "/v1/backups", {"id": f"b-{n}"})
    for n in range(many):
        yield ask("DELETE", f"/v1/backups/b-{n}")


@case("get_erasure", map=(400, 8_000), alone=True)
def of_a_map_of_keyframes_in_a_row(ground, body, many, most):
    path = of_keyframes(ground, many)
    erasure = ground.do("POST", f"{path}/erase", {"keyframes": ["kf-0"]})["id"]
    ground.rest()
    while True:
        yield ask("GET", f"{path}/erase/{erasure}")


# Texts: their length is the size of the body.

def texts(operation, shape, of):
    def run(ground, body, many, most):
        for turn in ground.numbers:
            yield ask("POST", f"/v1/semantics/{operation.split('_')[0]}", of(body, turn))
    CASES.append(Case(operation, shape, (), (4_000, 4_000), None, run))


def pair(a, b):
    return {"a": a, "b": b}


SHAPES_OF_TEXT = {
    "one letter": lambda n, turn: "a" * (n - 9) + f" {turn}",
    "words of one letter": lambda n, turn: " ".join("abcdefghij"[i % 10] for i in range(n // 2 - 5)) + f" {turn}",
    "numbers": lambda n, turn: " ".join(str(100 + i) for i in range((n - 9) // 4)) + f" {turn}",
    "letters that are put together": lambda n, turn: "e\u0301" * (n // 2 - 5) + f" {turn}",
}
for told, text_of in SHAPES_OF_TEXT.items():
    texts("information", told, lambda n, turn, text_of=text_of: {"text": text_of(n, turn)})
    texts("similarity", told, lambda n, turn, text_of=text_of: pair(text_of(n, turn), text_of(n, turn + 1)[::-1]))
    texts("merge_text", told, lambda n, turn, text_of=text_of: pair(text_of(n, turn), text_of(n, turn + 1)[::-1]))
