"""The law of costs, and the table of what may cost more.

Four times the body may cost four times as much; four times the map as much as its logarithm grows. An exception says by which power
of the map (or of the body) a request may grow instead, why, and how many CPU seconds it may take at most at the sizes of the
long form.
"""

import math
from typing import NamedTuple

# Noise of a busy machine, and what is too little to be judged.
NOISE, IGNORED_S = 2.0, 0.05
FOLD = 4


class Allowed(NamedTuple):
    power: float
    most_s: float
    why: str


EVERY_FACT = "reads, writes or removes each fact of the map"
EVERY_TEXT = "judges each text of the map anew"
SEEN = "compares each two keyframes that see a changed point, 200 million pairs at most in a request"
NAMED = "weighs each sign of the map that may be the one that is seen"
PLACED = "moves the box of each anchor that has the points"
MOVED = "moves each keyframe of the session"
SHARED = "counts the points that it shares with each keyframe, of which most are crowded in the larger map"
JOINED = "computes the frame of each session anew"
POSTED = "adds up each word of each keyframe that has it"
LOOKED = "looks at each entry until the page is full"

# By operation and shape, or by operation alone: how it may grow with the map.
MAP = {
    "export_map": Allowed(1, 2, EVERY_FACT),
    "get_trajectory": Allowed(1, 1, EVERY_FACT),
    "publish_release": Allowed(1, 4, EVERY_FACT),
    "delete_release": Allowed(1, 4, EVERY_FACT),
    "delete_map": Allowed(1, 4, EVERY_FACT),
    "take_backup": Allowed(1, 6, EVERY_FACT),
    "erase": Allowed(1, 20, "writes the file of the database anew"),
    "get_changes": Allowed(1, 0.5, "compares the two versions whole"),
    ("put_map", "a copy of a map"): Allowed(1, 2, EVERY_FACT),
    "patch_map": Allowed(1, 2, EVERY_TEXT),
    ("patch_map", "the least of shared points where every keyframe sees all"): Allowed(2, 6, "counts anew what each two keyframes share"),
    ("patch_map", "matching_min_similarity_level over many texts"): Allowed(2, 4, "compares texts that share words"),
    "listen": Allowed(1, 1, "sends each event since the one that is named"),
    "merge_sessions": Allowed(1, 4, MOVED),
    "revoke_merge": Allowed(1, 4, MOVED),
    "get_local_anchor_map": Allowed(1, 1, "lists each sign of the neighbours"),
    "get_frames": Allowed(1, 1, JOINED),
    ("confirm_loop", "one more between many sessions"): Allowed(1, 1, JOINED),
    ("revoke_loop", "one of many between many sessions"): Allowed(1, 1, JOINED),
    ("list_maps", "maps that patterns of a key hardly miss"): Allowed(1, 1, LOOKED),
    ("list_anchors", "words that no text has"): Allowed(1, 0.5, LOOKED),
    ("change_observations", "points fused that every keyframe sees"): Allowed(2, 6, SEEN),
    ("change_observations", "points fused into one that every keyframe sees"): Allowed(2, 6, SEEN),
    ("change_observations", "points culled that every keyframe sees"): Allowed(2, 6, SEEN),
    ("change_observations", "points fused that many anchors have"): Allowed(1, 4, PLACED),
    ("change_observations", "points culled that many anchors have"): Allowed(1, 4, PLACED),
    ("correct_poses", "places of points that many anchors have"): Allowed(1, 4, PLACED),
    ("query_loop", "a stored keyframe whose neighbours have signs of their own"): Allowed(2, 1, "compares the signs of all its neighbours"),
    ("query_loop", "signs that all say EXIT in one place"): Allowed(1, 2, NAMED),
    ("query_loop", "signs that all say EXIT apart"): Allowed(1, 2, NAMED),
    ("locate", "signs of another number each in one place"): Allowed(1, 2, NAMED),
    ("locate", "signs of another number each in one place, four times"): Allowed(1, 4, NAMED),
    ("put_keyframe", "signs of another number each in one place, with its query"): Allowed(1, 3, NAMED),
    ("put_keyframe", "signs that all say EXIT in one place, with its query"): Allowed(1, 3, NAMED),
    ("put_keyframe", "signs that all say EXIT apart, with its query"): Allowed(1, 3, NAMED),
    ("query_loop", "signs of another number each in one place"): Allowed(1, 2, NAMED),
    ("query_loop", "points that every keyframe sees"): Allowed(2, 1, SHARED),
    ("put_keyframe", "points that every keyframe sees"): Allowed(2, 1, SHARED),
    ("put_keyframe", "points that every keyframe sees, with its query"): Allowed(2, 1, SHARED),
    ("put_keyframes", "points that every keyframe sees"): Allowed(2, 1, SHARED),
    ("put_keyframe", "features of points that every keyframe sees"): Allowed(2, 1, SHARED),
    ("put_keyframe", "features of points that every keyframe sees, with its query"): Allowed(2, 1, SHARED),
    ("put_keyframes", "features of points that every keyframe sees"): Allowed(2, 1, SHARED),
    ("query_loop", "words that every keyframe has"): Allowed(1, 1, POSTED),
    ("query_loop", "words that every keyframe has, of another session"): Allowed(1, 1, POSTED),
    ("put_keyframe", "words that every keyframe has, with its query"): Allowed(1, 1, POSTED),
    ("locate", "words that every keyframe has"): Allowed(1, 1, POSTED),
    ("locate", "words that every keyframe has, four times"): Allowed(1, 4, POSTED),
    ("query_loop", "as many candidates as there may be"): Allowed(1, 10, "weighs as many candidates as the map's settings allow"),
}
# The same for the body.
BODY = {
}
# Lists that need no case.
LISTS = {
    ("put_prior_anchor", "position"): "three numbers exactly",
    ("put_prior_anchor", "normal"): "three numbers exactly",
}
# Operations that need no case.
OPERATIONS = {}


def allowed(table, case):
    return table.get((case.operation, case.shape)) or table.get(case.operation)


def faults(case, most, smaller_body, smaller_map, many):
    """What breaks the law: the cost at the largest sizes, and with a quarter of the body or of the map."""
    if most < IGNORED_S:
        return
    for axis, table, smaller, growth in (("body", BODY, smaller_body, FOLD), ("map", MAP, smaller_map, logarithm(many))):
        rule = allowed(table, case)
        limit = NOISE * (FOLD ** rule.power if rule else growth)
        if smaller and most > limit * smaller:
            yield f"four times the {axis} cost {most / smaller:.1f} times as much, not at most {limit:.1f} times"
        if rule and most > rule.most_s:
            yield f"{most:.2f} s, not at most {rule.most_s} s"


def logarithm(many):
    """By how much the logarithm of a map of so many grows over one of a quarter."""
    return math.log(many) / math.log(many / FOLD) if many else 1.0


def gaps(cases, operations):
    """What the document has and no case, and the reverse."""
    covered = {}
    for case in cases:
        covered.setdefault(case.operation, set()).update(case.lists)
    for operation, (_, _, lists) in operations.items():
        if operation not in covered and operation not in OPERATIONS:
            yield f"{operation} has no case"
        for name in lists.keys() - covered.get(operation, set()):
            if (operation, name) not in LISTS:
                yield f"the list {name} of {operation} has no case"
    for operation, names in covered.items():
        for name in sorted(names - operations.get(operation, (None, None, {}))[2].keys()):
            yield f"the document has no list {name} of {operation}"
    for named in (*LISTS, *((operation, None) for operation in OPERATIONS)):
        if named[0] not in operations or named[1] is not None and named[1] not in operations[named[0]][2]:
            yield f"the document has no {named}"
    for named in (*MAP, *BODY):
        if not any(named in (case.operation, (case.operation, case.shape)) for case in cases):
            yield f"no case is {named}"
