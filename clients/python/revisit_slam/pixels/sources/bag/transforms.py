"""Transforms: the tree of frames that a robot does not move within itself, from `/tf_static`."""

from __future__ import annotations

from collections import deque
from contextlib import suppress
from typing import Any

import numpy as np

from ....errors import RevisitError
from ....imports.rtabmap.messages import transform_of


class StaticTransforms:
    """Frames joined by fixed transforms."""

    def __init__(self) -> None:
        self._joined: dict[str, dict[str, np.ndarray]] = {}

    def add(self, message: Any) -> None:
        """Add a `tf2_msgs/msg/TFMessage`, but what is none in it; of two transforms between the same frames the later counts."""
        for stamped in message.transforms:
            parent, child = stamped.header.frame_id.lstrip("/"), stamped.child_frame_id.lstrip("/")
            with suppress(RevisitError):
                parent_from_child = transform_of(stamped.transform, "it")
                self._joined.setdefault(parent, {})[child] = parent_from_child
                self._joined.setdefault(child, {})[parent] = np.linalg.inv(parent_from_child)

    def between(self, frame: str, other: str) -> np.ndarray | None:
        """Return `frame_from_other` (4 x 4) by the shortest way; None where nothing joins the two."""
        frame, other = frame.lstrip("/"), other.lstrip("/")
        found, ahead = {frame: np.eye(4)}, deque([frame])
        while ahead and other not in found:
            here = ahead.popleft()
            for there, here_from_there in self._joined.get(here, {}).items():
                if there not in found:
                    found[there] = found[here] @ here_from_there
                    ahead.append(there)
        return found.get(other)
