"""Sightings: `vision_msgs/Detection2D` as the API takes detections, each at its place."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..imports.limits import MAX_DETECTIONS
from ..imports.poses import moved
from ..pixels.pinhole import MAX_PIXEL, Pinhole
from .pictures import crop

MAX_CLASS, MAX_TEXT = 64, 4096


@dataclass(frozen=True)
class Reading:
    """Where a detection's text comes from, and how far a sign is taken to be that nothing measured."""

    text_from: str = "crop"
    """`crop`: the server reads the picture; `id`: the detector put its reading there; `none`."""
    assumed_distance_m: float = 3.0


def detections_of(
    messages: Any, camera: Pinhole, map_from_camera: np.ndarray, picture: np.ndarray | None, reading: Reading
) -> list[dict[str, Any]]:
    """Return detections; those without a hypothesis, or with a box that is none, are left out."""
    found = []
    for message in list(messages)[:MAX_DETECTIONS]:
        box = _box(message.bbox)
        if not len(message.results) or box is None:
            continue
        best = max(message.results, key=lambda result: result.hypothesis.score)
        body: dict[str, Any] = {
            "class": str(best.hypothesis.class_id)[:MAX_CLASS] or "sign",
            "confidence": float(np.clip(np.nan_to_num(best.hypothesis.score), 0, 1)),
            "box": box,
        }
        body |= _place(best.pose.pose.position, box, camera, map_from_camera, reading)
        if reading.text_from == "id" and message.id.strip():
            body["text"] = message.id.strip()[:MAX_TEXT]
        seen = crop(picture, box) if reading.text_from == "crop" and picture is not None else None
        if seen is not None:
            body["crop"] = seen
        found.append(body)
    return found


def _box(message: Any) -> list[float] | None:
    """Return the upright box around a turned one; None where it is none."""
    half = np.abs([message.size_x, message.size_y]) / 2
    turn = float(message.center.theta)
    c, s = abs(np.cos(turn)), abs(np.sin(turn))
    reach = np.array([c * half[0] + s * half[1], s * half[0] + c * half[1]])
    centre = np.array([message.center.position.x, message.center.position.y])
    box = [*(centre - reach), *(centre + reach)]
    return [float(value) for value in box] if (np.abs(box) <= MAX_PIXEL).all() else None


def _place(position: Any, box: list[float], camera: Pinhole, map_from_camera: np.ndarray, reading: Reading) -> dict[str, Any]:
    """Return where it stands: as the detector measured it in the camera's frame, or along its ray as far as is assumed."""
    point = np.array([position.x, position.y, position.z], float)
    measured = bool(np.isfinite(point).all() and point[2] > 0)
    if not measured:
        # Along the ray, not the axis: turning the camera must not move the sign.
        centre = np.array([[(box[0] + box[2]) / 2, (box[1] + box[3]) / 2]])
        point = camera.bearings(centre)[0] * reading.assumed_distance_m
    place = {"position": [float(value) for value in moved(map_from_camera, point[None])[0]]}
    return place if measured else {**place, "range": "assumed"}
