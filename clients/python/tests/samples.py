"""Keyframes for tests."""

from typing import Any


def keyframe(second: int, text: str | None = None, x: float = 0.0, words: tuple[int, ...] = (3, 17, 42)) -> dict[str, Any]:
    """Return a keyframe at `x` metres that may read a text two metres ahead."""
    body: dict[str, Any] = {
        "stamp": {"sec": second, "nanosec": 0},
        "pose": {"translation": {"x": x, "y": 0, "z": 0}, "rotation": {"x": 0, "y": 0, "z": 0, "w": 1}},
        "bow": {"words": list(words), "weights": [1.0] * len(words)},
    }
    if text is not None:
        body["detections"] = [
            {"class": "door_number", "confidence": 0.9, "box": [300, 200, 340, 220], "position": [x, 0, 2], "text": text}
        ]
    return body
