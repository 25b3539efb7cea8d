"""Packed columns are the lists that they stand for, and what cannot be packed stays a list."""

from __future__ import annotations

import base64
import struct
from array import array

import msgspec
import pytest

from revisit_slam import Client, bulk, models
from revisit_slam.packing import packed

COUNT = 40


def keyframe() -> dict:
    """Return a keyframe whose columns are long enough to be packed."""
    numbers = list(range(COUNT))
    return {
        "stamp": {"sec": 1, "nanosec": 0},
        "pose": {"translation": {"x": 0, "y": 0, "z": 0}, "rotation": {"x": 0, "y": 0, "z": 0, "w": 1}},
        "bow": {"words": numbers, "weights": [0.1 + number for number in numbers]},
        "features": {
            "descriptor_bytes": 8,
            "descriptors": base64.b64encode(bytes(8 * COUNT)).decode(),
            "keypoints": [[number + 0.5, number * 2.0, number % 8, number * 3.25] for number in numbers],
            "map_points": [number if number % 2 else -1 for number in numbers],
        },
        "map_points": {"ids": numbers, "positions": [[number * 0.1, 1.0, 2.0] for number in numbers]},
        "observes": numbers,
    }


def test_each_long_column_is_packed_and_reads_back() -> None:
    lists, body = keyframe(), packed(keyframe())
    assert "observes" not in body and "keypoints" not in body["features"] and "words" not in body["bow"]
    numbers = struct.unpack(f"<{4 * COUNT}f", base64.b64decode(body["features"]["keypoints_f32"]))
    assert [list(numbers[at : at + 4]) for at in range(0, len(numbers), 4)] == lists["features"]["keypoints"]
    assert list(struct.unpack(f"<{COUNT}q", base64.b64decode(body["observes_i64"]))) == lists["observes"]
    assert lists == keyframe(), "the body that was given is not changed"


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("keypoints", [[0.1, 0.2]] * COUNT),
        ("keypoints", [[1.0]] * COUNT),
        ("map_points", [1.5] * COUNT),
        ("map_points", [1 << 70] * COUNT),
        ("map_points", [1, 2]),
        ("map_points", "12"),
    ],
)
def test_what_would_not_come_back_exactly_stays_as_it_is(name: str, value: object) -> None:
    body = keyframe()
    body["features"][name] = value
    assert packed(body)["features"][name] == value


def test_arrays_and_structs_are_bodies_too() -> None:
    body = keyframe()
    body["map_points"]["ids"] = array("q", range(COUNT))
    assert packed(body) == packed(keyframe())
    assert packed(msgspec.convert(keyframe(), models.Keyframe)) == packed(keyframe())


def test_a_packed_retry_of_a_keyframe_sent_as_lists_is_a_retry(client: Client, map_id: str) -> None:
    line = msgspec.json.encode({"id": "kf-1", **keyframe()})
    (first,) = bulk.lines_of(client._call(bulk.call_of(map_id, line)))
    (again,) = client.put_keyframes(map_id, [{"id": "kf-1", **keyframe()}])
    assert (first.status, again.status) == (201, 200) and again.idempotent_replayed
    assert client.put_keyframe(map_id, "kf-1", keyframe()).map_version == first.map_version
    stored = client.get_keyframe(map_id, "kf-1")
    assert stored.features is not None and stored.features.keypoints == keyframe()["features"]["keypoints"]
