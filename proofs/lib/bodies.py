"""Random bodies that the API allows: any order, gaps, repeats, and the extremes of every field."""

import base64

LARGEST_POINT = 2**63 - 1
TEXTS = ["901", "9O1", "EXIT", "Ausgang – Ärztehaus", "出口 3", "مخرج", "e\u0301tage 5", "é", "👩‍🚒 42", "\"quoted\\\" / \u2028", "\u200f", " ",
         "a painting of a red boat", "7.04", "0", "Level 5", "x" * 4096, "\ttab\n", "\ufeffbom", "Ǆ ǆ ß ﬁ", "\U0010ffff"]
CLASSES = ["door_number", "sign", "Türschild", "出口", "a b", "k" * 64]
SESSIONS = [None, "a", "Z.9:_-", "s" * 128]
# Floats at the edge of what there is, within [-1, 1].
EDGES = [0.0, -0.0, 1.0, 5e-324, -5e-324, 2.2250738585072014e-308, 1e-300, 0.1, -0.1, 1 / 3, 0.9999999999999999]
PNG, JPEG = b"\x89PNG\r\n\x1a\n", b"\xff\xd8\xff"


def number(chance, low, high):
    """A float of [low, high], often one of its ends, a zero of either sign or a subnormal."""
    edges = [edge for edge in EDGES if low <= edge <= high] + [low, high]
    pick = chance.random()
    if pick < 0.5:
        return chance.uniform(low, high)
    if pick < 0.7:
        return float(chance.randint(int(low), int(high)))
    return chance.choice(edges)


def length(chance):
    """A coordinate in metres: mostly within a building."""
    return number(chance, -1e9, 1e9) if chance.random() < 0.15 else number(chance, -5, 5)


def points(chance, at_most):
    """Numbers of map points, shared by many keyframes and at both ends of what there is; any order, repeats."""
    pool = [*range(60), 2**31, 2**32, 2**53 - 1, 2**53 + 1, LARGEST_POINT - 1, LARGEST_POINT]
    chosen = [chance.choice(pool) for _ in range(chance.randint(0, at_most))]
    order = chance.random()
    return sorted(chosen, reverse=True) if order < 0.2 else sorted(chosen) if order < 0.4 else chosen


def unique(chance, items):
    items = list(dict.fromkeys(items))
    chance.shuffle(items)
    return items


def rotation(chance):
    if chance.random() < 0.3:
        parts = chance.choice([[0, 0, 0, 1], [0.0, -0.0, 1.0, 0.0], [5e-324, 0, 0, -1], [0.5, -0.5, 0.5, 0.5], [1.005, 0, 0, 0]])
    else:
        parts = [chance.gauss(0, 1) for _ in range(4)]
        norm = sum(part * part for part in parts) ** 0.5 * chance.choice([1, 1, 0.995, 1.005])
        parts = [part / norm for part in parts] if norm > 0.1 else [0, 0, 0, 1]
    return dict(zip("xyzw", parts))


def pose(chance):
    return {"translation": {axis: length(chance) for axis in "xyz"}, "rotation": rotation(chance)}


def placed(chance, at_most):
    ids = unique(chance, points(chance, at_most))
    return {"ids": ids, "positions": [[length(chance) for _ in range(3)] for _ in ids]}


def bow(chance):
    words = unique(chance, [chance.choice([*range(40), 2**31, 2**32 - 1]) for _ in range(chance.randint(0, 30))])
    weights = [chance.choice([0, 0.0, -0.0, 5e-324, 1e-300, 1e30, 1, 0.5, chance.random()]) for _ in words]
    return {"words": words, "weights": weights}


def features(chance):
    count, each = chance.choice([0, 1, 2, 17, 40]), chance.choice([8, 16, 24, 32, 40, 64, 512])
    keypoint = lambda: [number(chance, -1e6, 1e6), number(chance, -1e6, 1e6), chance.choice([0, 63, chance.randint(0, 7)]),
                        number(chance, -360, 360)][:chance.randint(2, 4)]
    body = {"descriptor_bytes": each, "descriptors": base64.b64encode(chance.randbytes(each * count)).decode(),
            "keypoints": [keypoint() for _ in range(count)]}
    if chance.random() < 0.8:
        body["map_points"] = [chance.choice([-1, LARGEST_POINT, chance.randint(0, 60)]) for _ in range(count)]
    return body


def detection(chance):
    x0, x1 = sorted(number(chance, -1e6, 1e6) for _ in range(2))
    y0, y1 = sorted(number(chance, -100, 5000) for _ in range(2))
    body = {"class": chance.choice(CLASSES), "confidence": number(chance, 0, 1), "box": [x0, y0, x1, y1]}
    if chance.random() < 0.7:
        body["map_points"] = points(chance, 12)
    if chance.random() < 0.6:
        body["position"] = [length(chance) for _ in range(3)]
    for name in "text", "description":
        if chance.random() < 0.5:
            body[name] = chance.choice(TEXTS)
    if chance.random() < 0.3:
        body["crop"] = base64.b64encode(chance.choice([PNG, JPEG]) + chance.randbytes(chance.randint(0, 200))).decode()
    return body


def keyframe(chance, known=()):
    """A keyframe; `known` are the names of those that it may declare covisible."""
    body = {"stamp": {"sec": chance.choice([0, -62_135_596_800, 253_402_300_799, chance.randint(0, 10**9)]),
                      "nanosec": chance.choice([0, 999_999_999, chance.randint(0, 999_999_999)])}, "pose": pose(chance)}
    may = {
        "session": lambda: chance.choice(SESSIONS[1:]),
        "camera": lambda: {"fx": number(chance, 1e-3, 1e6), "fy": 525.0, "cx": number(chance, -1e6, 1e6), "cy": -0.0,
                           "width": chance.choice([1, 640, 1_000_000]), "height": chance.choice([1, 480, 1_000_000])},
        "bow": lambda: bow(chance), "features": lambda: features(chance), "map_points": lambda: placed(chance, 40),
        "observes": lambda: points(chance, 60),
        "covisible": lambda: [{"keyframe": name, "shared": chance.choice([0, 1, 2**32 - 1, chance.randint(0, 500)])}
                              for name in unique(chance, chance.choices(list(known), k=chance.randint(0, 5)) if known else [])],
        "detections": lambda: [detection(chance) for _ in range(chance.choice([0, 1, 2, 3, 8]))],
    }
    names = [name for name in may if chance.random() < 0.75]
    # The fields in any order, too.
    chance.shuffle(names)
    return body | {name: may[name]() for name in names}
