"""A robot without map points: poses and plates, as in the README, and nothing that says which keyframes are neighbours."""

from collections.abc import Iterator
from typing import Any

from revisit_slam import Client

PLATES = {"901": (2.0, 1.0), "903": (9.0, -2.0), "905": (6.0, -5.0), "907": (-1.0, -2.0)}
SIGHT_M = 2.2


def lap() -> Iterator[tuple[float, float]]:
    """Yield the places of a lap around a block of 8 m by 4 m, half a metre from one to the next."""
    yield from ((step / 2, 0.0) for step in range(16))
    yield from ((8.0, -step / 2) for step in range(8))
    yield from ((8.0 - step / 2, -4.0) for step in range(16))
    yield from ((0.0, step / 2 - 4.0) for step in range(8))


def body(second: int, x: float, z: float) -> dict[str, Any]:
    near = {plate: at for plate, at in PLATES.items() if (at[0] - x) ** 2 + (at[1] - z) ** 2 < SIGHT_M**2}
    return {
        "stamp": {"sec": second, "nanosec": 0},
        "pose": {"translation": {"x": x, "y": 0, "z": z}, "rotation": {"x": 0, "y": 0, "z": 0, "w": 1}},
        "bow": {"words": [3, 17, 42], "weights": [1, 1, 1]},
        "detections": [
            {"class": "door_number", "confidence": 0.9, "box": [300, 200, 340, 220], "position": [at[0], 0, at[1]], "text": plate}
            for plate, at in near.items()
        ],
    }


def test_two_laps_past_four_plates_make_four_anchors_and_the_second_laps_loops(client: Client, map_id: str) -> None:
    closed = []
    places = list(lap())
    for second, (x, z) in enumerate(places * 2):
        asked = client.put_keyframe(map_id, f"kf-{second}", body(second, x, z), query="loop")
        assert asked.loop is not None
        if asked.loop.verdict == "loop":
            client.confirm_loop(map_id, {"id": f"l-{second}", "keyframe": f"kf-{second}", "candidate": asked.loop.best})
            closed.append((second, int(str(asked.loop.best).removeprefix("kf-"))))
    assert client.get_map(map_id).anchors == len(PLATES)
    assert 1 <= len(closed) <= len(PLATES), closed
    for second, earlier in closed:
        assert second >= len(places) > earlier, closed
        assert abs(second - len(places) - earlier) <= 4, closed
