"""Detections: signs as the API takes them, each at its place."""

from __future__ import annotations

import base64
from typing import Any

import cv2
import numpy as np

from .frames import View
from .pinhole import Pinhole
from .ranges import Ranges
from .signs import Sign

MAX_CROP_PX = 320


def detection(
    sign: Sign, view: View, camera: Pinhole, session_from_camera: np.ndarray, ranges: Ranges, crops: bool
) -> dict[str, Any]:
    """Return a sign as a detection of the API; where its distance is a guess it says so."""
    x0, y0, x1, y1 = sign.box
    centre = np.array([[(x0 + x1) / 2, (y0 + y1) / 2]])
    depth = ranges.measured(sign.box)
    if depth is not None:
        point = camera.rays(centre)[0] * depth
    else:
        # Along the ray, not the axis: turning the camera must not move the sign.
        point = camera.bearings(centre)[0] * ranges.guessed(sign.letters_px)
    position = session_from_camera[:3, :3] @ point + session_from_camera[:3, 3]
    body: dict[str, Any] = {
        "class": sign.kind,
        "confidence": round(sign.confidence, 3),
        "box": list(sign.box),
        "position": [round(float(value), 4) + 0.0 for value in position],
    }
    if depth is None:
        body["range"] = "assumed"
    body["text"] = sign.text
    if crops:
        crop = _crop(view, sign.box)
        if crop is not None:
            body["crop"] = crop
    return body


def _crop(view: View, box: tuple[float, float, float, float]) -> str | None:
    """Return what a box shows, as a person sees it."""
    height, width = view.image.shape[:2]
    x0, y0 = max(int(box[0]), 0), max(int(box[1]), 0)
    x1, y1 = min(int(np.ceil(box[2])), width), min(int(np.ceil(box[3])), height)
    if x1 - x0 < 2 or y1 - y0 < 2:
        return None
    part = view.turn.seen(view.image[y0:y1, x0:x1])
    scale = min(1.0, MAX_CROP_PX / max(part.shape[:2]))
    if scale < 1.0:
        part = cv2.resize(part, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
    done, data = cv2.imencode(".jpg", part, [cv2.IMWRITE_JPEG_QUALITY, 85])
    return base64.b64encode(data.tobytes()).decode() if done else None
