"""The maps whose pace is measured: a robot in a building, with words only, with signs and map points as well, or with features."""

import base64
import json
import random
import struct

WORDS, KEPT_OF_THE_LAST, IN_BUILDING, IN_VOCABULARY = 700, 400, 60_000, 1_000_003
# Each keyframe sees the signs and the points ahead of it, one metre farther than the one before.
SIGNS_SEEN, EXIT_EVERY, POINTS_EACH_METRE, METRES_SEEN, CORRIDOR_M = 20, 10, 10, 15, 100

# What ORB-SLAM3 keeps of a keyframe: 1,000 features of 32 bytes, of which half see a map point, all of them new.
FEATURES, POINTS_NEW, DESCRIPTOR_BYTES = 1_000, 500, 32


def words_of(keyframes, seed):
    """Words of a robot's keyframes: each shares most of its words with the one before."""
    drawn, words = random.Random(seed), []
    for _ in range(keyframes):
        chosen = set(drawn.sample(words, min(len(words), KEPT_OF_THE_LAST)))
        while len(chosen) < WORDS:
            chosen.add(int(drawn.random() ** 1.72 * IN_BUILDING) * 617 % IN_VOCABULARY)
        words = sorted(chosen)
        yield words


def keyframe(number, at, words):
    return {"id": f"kf-{number}", "stamp": {"sec": number, "nanosec": 0},
            "pose": {"translation": dict(zip("xyz", at)), "rotation": {"x": 0, "y": 0, "z": 0, "w": 1}},
            "bow": {"words": words, "weights": [1] * WORDS}}


def line(body):
    return json.dumps(body, separators=(",", ":")).encode() + b"\n"


def words_only(keyframes):
    """Lines of keyframes that have words and nothing else."""
    for number, words in enumerate(words_of(keyframes, 3)):
        yield line(keyframe(number, (number * 0.1, 0, 0), words))


def along(metre):
    """Where a metre of the way lies: corridors side by side, the next one driven the other way."""
    corridor, way = divmod(metre, CORRIDOR_M)
    return (way if corridor % 2 == 0 else CORRIDOR_M - 1 - way, 10 * corridor, 0)


def sign(number):
    """One sign: every tenth says EXIT, the others have a number that is theirs alone."""
    x, y, z = along(number)
    text = "EXIT" if number % EXIT_EVERY == 0 else f"Room {number}"
    return {"class": "sign", "confidence": 0.9, "box": [100, 100, 180, 140], "position": [x, y + 1.5, z + 1], "text": text}


def with_signs(keyframes):
    """Lines of keyframes that see twenty signs each: as many signs as keyframes in all."""
    for number, words in enumerate(words_of(keyframes, 5)):
        body = keyframe(number, along(number), words)
        body["detections"] = [sign(number + ahead) for ahead in range(SIGNS_SEEN)]
        body["observes"] = list(range(POINTS_EACH_METRE * number, POINTS_EACH_METRE * (number + METRES_SEEN)))
        yield line(body)


def column(numbers, kind):
    return base64.b64encode(struct.pack(f"<{len(numbers)}{kind}", *numbers)).decode()


def with_features(number, packed):
    """A keyframe as a SLAM system has it, without words; its long columns as lists or packed."""
    drawn = random.Random(number)
    points = list(range(number * POINTS_NEW, (number + 1) * POINTS_NEW))
    seen = [-1] * FEATURES
    for feature, point in zip(drawn.sample(range(FEATURES), POINTS_NEW), points):
        seen[feature] = point
    keypoints = [[drawn.randrange(64_000) / 100, drawn.randrange(48_000) / 100, drawn.randrange(8), drawn.randrange(3_600) / 10]
                 for _ in range(FEATURES)]
    positions = [[drawn.randrange(-100_000, 100_000) / 10_000 for _ in range(3)] for _ in points]
    features = {"descriptor_bytes": DESCRIPTOR_BYTES,
                "descriptors": base64.b64encode(drawn.randbytes(DESCRIPTOR_BYTES * FEATURES)).decode()}
    flat = lambda rows: [value for row in rows for value in row]  # noqa: E731
    if packed:
        features |= {"keypoints_f32": column(flat(keypoints), "f"), "map_points_i64": column(seen, "q")}
        placed = {"ids_i64": column(points, "q"), "positions_f64": column(flat(positions), "d")}
    else:
        features |= {"keypoints": keypoints, "map_points": seen}
        placed = {"ids": points, "positions": positions}
    body = {"session": "robot-1", "stamp": {"sec": number, "nanosec": 5},
            "pose": {"translation": {"x": number * 0.1, "y": 0, "z": 2.2}, "rotation": {"x": 0, "y": 0, "z": 0, "w": 1}},
            "camera": {"fx": 525, "fy": 525, "cx": 320, "cy": 240, "width": 640, "height": 480},
            "features": features, "map_points": placed}
    return json.dumps(body, separators=(",", ":")).encode()
