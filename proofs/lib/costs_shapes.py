"""Keyframes that are hard on a server, each kind with the map that makes it so, by the number of entries of one list.

A map's keyframes have the largest list, whatever the size of the body that is asked, so that both may grow alone.
"""

import random
from typing import Callable, NamedTuple

from costs_measure import encoded, packed

CAMERA = {"fx": 525, "fy": 525, "cx": 320, "cy": 240, "width": 640, "height": 480}
BYTES = 32
RANDOM = random.Random(1).randbytes(BYTES * 20_000)
SHARED_WORDS = " ".join(f"word{n}" for n in range(24))
# Keyframes so far apart are no neighbours by their way; so close together they all are.
APART_M, TOGETHER_M = 10.0, 0.01


class Shape(NamedTuple):
    """`make(n)` is the content of a keyframe with n entries, `lists` the lists that have them. `body` and `map` are the
    largest numbers of entries and of the map's keyframes, in the short form and in the long one."""

    name: str
    lists: tuple
    make: Callable
    body: tuple
    map: tuple | None
    # What the map's keyframes have, if it is not the same: of the largest list, and their number.
    mapped: Callable | None = None
    step: float = TOGETHER_M
    # What the map's settings differ in.
    settings: dict | None = None

    def lines(self, most, many):
        same = None if self.mapped else self.make(most)
        for number in range(many):
            yield keyframe(number, same or self.mapped(most, number), self.step, id=f"kf-{number}")


def pose(x=0.0, y=0.0):
    return {"translation": {"x": x, "y": y, "z": 0.0}, "rotation": {"x": 0, "y": 0, "z": 0, "w": 1}}


def keyframe(number, content, step=TOGETHER_M, **more):
    return {"stamp": {"sec": number, "nanosec": 0}, "pose": pose(number * step)} | content | more


def words(n, first=0):
    return {"bow": {"words_u32": packed(range(first, first + n), "I"), "weights_f64": packed([1.0] * n, "d")}}


def observed(n, first=0):
    return {"observes_i64": packed(range(first, first + n), "q")}


def placed(n):
    return {"map_points": {"ids_i64": packed(range(n), "q"), "positions_f64": packed([0.5] * (3 * n), "d")}}


def features(n, descriptors, at):
    flat = [value for i in range(n) for value in at(i)]
    return words(50) | {"camera": CAMERA, "features": {
        "descriptor_bytes": BYTES, "descriptors": encoded(descriptors[:BYTES * n]), "keypoints_f32": packed(flat, "f")}}


def alike(n):
    """Features that all look the same, in one place of the image."""
    return features(n, bytes(BYTES * n), lambda i: (320.0, 240.0, 0.0, 0.0))


def spread(n):
    """Features that all look different, across the image."""
    return features(n, RANDOM, lambda i: (i * 7919 % 640, i * 104729 % 480, float(i % 8), 0.0))


def of_points(n):
    """Features that see a point each, of few bytes."""
    return {"camera": CAMERA, "features": {"descriptor_bytes": 8, "descriptors": encoded(RANDOM[:8 * n]),
                                           "keypoints_f32": packed([1.0, 2.0, 0.0, 0.0] * n, "f"), "map_points_i64": packed(range(n), "q")}}


def features_as_lists(n):
    return {"camera": CAMERA, "features": {"descriptor_bytes": 8, "descriptors": encoded(RANDOM[:8 * n]),
                                           "keypoints": [[i % 640, i % 480, 0, 0] for i in range(n)], "map_points": list(range(n))}}


def detection(text, at=(0.0, 0.0, 2.0), kind="sign", **more):
    return {"class": kind, "confidence": 0.9, "box": [100, 100, 180, 140], "position": list(at), "text": text} | more


def in_row(i, k=0):
    return (i * 2.0, k * 2.0, 2.0)


def here(i):
    return (0.0, 0.0, 2.0)


def signs(n, text, at=here, kind=lambda i: "sign"):
    return {"detections": [detection(text(i), at(i), kind(i)) for i in range(n)]}


def shuffled(number):
    order = SHARED_WORDS.split()
    random.Random(number).shuffle(order)
    return " ".join(order)


def each_of_its_own(text):
    """Ten signs to a keyframe of the map, each in another place and with another text."""
    return lambda n, k: signs(10, lambda i: text(10 * k + i), lambda i: in_row(i, k))


def sharing(i):
    return f"{SHARED_WORDS} and {i}"


def of_same_points(n, points=200):
    """Signs that each cover the same points."""
    return placed(points) | {"detections": [detection(f"Room {i}", map_points=list(range(points))) for i in range(n)]}


def a_class_of_its_own(n, i):
    """A keyframe whose one sign, of a class of its own, covers all points."""
    return placed(n) | {"detections": [detection(f"Room {i}", kind=f"class-{i}", map_points=list(range(n)))]}


def picture(n):
    """The image of a sign, of so many bytes."""
    return {"detections": [detection("EXIT", crop=encoded(b"\x89PNG\r\n\x1a\n" + RANDOM[:1] * (n - 8)))]}


def descriptor(n, i=0):
    return {"global_descriptor": {"model": "m", "encoding": "int8", "data": encoded(RANDOM[i:i + n])}}


# Geometry looks at keyframes without signs only where a map says so.
GEOMETRY = {"method": "paper", "without_anchors": "geometry", "geometry_models": "auto"}
WORDS, PLACES, FEATURES = ("bow.words_u32", "bow.weights_f64"), ("map_points.ids_i64", "map_points.positions_f64"), ("features.descriptors", "features.keypoints_f32")
SHAPES = [
    Shape("words that every keyframe has", WORDS, words, (2_000, 16_000), (400, 2_000), step=APART_M),
    Shape("words as lists", ("bow.words", "bow.weights"), lambda n: {"bow": {"words": list(range(n)), "weights": [1.0] * n}}, (40_000, 65_535), None),
    Shape("points that every keyframe sees", ("observes_i64",), observed, (1_000, 4_000), (200, 600)),
    Shape("points as lists", ("observes",), lambda n: {"observes": list(range(n))}, (100_000, 100_000), None),
    Shape("places of points that every keyframe sees", PLACES, placed, (1_000, 4_000), (200, 600), lambda n, _: observed(n)),
    Shape("places as lists", ("map_points.ids", "map_points.positions"),
          lambda n: {"map_points": {"ids": list(range(n)), "positions": [[0.5, 1.0, 2.0]] * n}}, (40_000, 80_000), None),
    Shape("places of points that many anchors have", PLACES, placed, (400, 2_000), (100, 400), a_class_of_its_own),
    Shape("features all alike", FEATURES, alike, (400, 8_000), (100, 200), step=APART_M, settings=GEOMETRY),
    Shape("features all different", FEATURES, spread, (400, 8_000), (100, 200), step=APART_M, settings=GEOMETRY),
    Shape("features as lists", ("features.keypoints", "features.map_points"), features_as_lists, (20_000, 20_000), None),
    Shape("features of points that every keyframe sees", ("features.map_points_i64",), lambda n: of_points(n) | placed(n), (1_000, 4_000), (100, 300)),
    Shape("signs that all say EXIT in one place", ("detections",), lambda n: signs(n, lambda i: "EXIT"), (100, 400), (40, 160)),
    Shape("signs that all say EXIT apart", ("detections",), lambda n: signs(n, lambda i: "EXIT", in_row), (100, 400), (40, 160)),
    Shape("signs of another number each in one place", ("detections",), lambda n: signs(n, lambda i: f"Room {i}"), (100, 400), (40, 160)),
    Shape("signs that share all words but one", ("detections",), lambda n: signs(n, sharing, in_row), (200, 500), (100, 400), each_of_its_own(sharing)),
    Shape("signs of the same words in another order", ("detections",), lambda n: signs(n, shuffled, in_row), (200, 500), (100, 400), each_of_its_own(shuffled)),
    Shape("signs that cover the same points", ("detections",), of_same_points, (60, 240), (8, 16)),
    Shape("a sign on points that every keyframe sees", ("detections[].map_points",),
          lambda n: placed(n) | {"detections": [detection("EXIT", map_points=list(range(n)))]}, (1_000, 4_000), (100, 400)),
    Shape("descriptors of the whole image", ("global_descriptor.data",), descriptor, (1_056, 1_056), (400, 8_000), descriptor, APART_M),
    Shape("a picture", ("detections[].crop",), picture, (4_000_000, 4_000_000), None),
    Shape("a sign on many points", ("detections[].map_points",),
          lambda n: {"detections": [detection("EXIT", map_points=list(range(n)))]}, (100_000, 100_000), None),
]
