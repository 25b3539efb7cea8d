"""Loop detector for pySLAM: its candidates come from Revisit, and pySLAM verifies them as it verifies its own.

pySLAM runs a detector in a process of its own, so that waiting for the server here holds up neither tracking nor mapping.
`LoopDetectorRevisit` is made with pySLAM's own classes, which this package does not import:
`LoopDetectorRevisit(LoopDetectorBase, LoopDetectorOutput, client, "tower", camera=..., pose_of=...)`.
"""

from __future__ import annotations

import base64
from collections.abc import Callable
from typing import Any

import numpy as np

from .client import Client
from .imports import poses
from .problems import RevisitError

TASKS = ("LOOP_CLOSURE", "COMPUTE_GLOBAL_DES")


def LoopDetectorRevisit(base: type, output: type, client: Client, map: str, **options: Any) -> Any:  # noqa: N802
    """Return a detector that pySLAM's loop closing takes: an instance of `base`, pySLAM's `LoopDetectorBase`.

    `pose_of(frame_id)` returns `(seconds, map_from_camera)` of a keyframe, as a 4 by 4 matrix; pySLAM's task does not have it.
    `camera` is the pinhole of the undistorted keypoints. `detections_of(image)` returns the signs on an image, as the API has them.
    """

    class Detector(base):  # type: ignore[misc]
        def __init__(
            self,
            pose_of: Callable[[int], tuple[float, Any]],
            camera: dict[str, Any],
            session: str = "pyslam",
            detections_of: Callable[[Any], list[dict[str, Any]]] | None = None,
            words_of: Callable[[Any], tuple[list[int], list[float]]] | None = None,
        ) -> None:
            super().__init__()
            self.pose_of, self.camera, self.session = pose_of, camera, session
            self.detections_of, self.words_of = detections_of, words_of

        def run_task(self, task: Any) -> Any:
            """Send the task's keyframe and return the candidates; none where the server does not answer."""
            keyframe, kind = task.keyframe_data, task.task_type.name
            answer = output(task_type=task.task_type, frame_id=keyframe.id, img=keyframe.img)
            if kind not in TASKS:
                return answer
            try:
                client.put_keyframe(map, self.name(keyframe.id), self.body(keyframe))
                self.entry_id += 1
                if kind == "LOOP_CLOSURE":
                    verdict = client.query_loop(map, {"keyframe": self.name(keyframe.id), "verify": "anchors"})
                    # pySLAM verifies by itself: what Revisit cannot decide is for it, what the signs contradict is not.
                    found = [c for kept in ("loop", "undecided") for c in verdict.candidates if c.verdict == kept]
                    found = [c for c in found if c.keyframe.startswith(f"{self.session}-")]
                    found = [c for c in found if self.number(c.keyframe) not in task.connected_keyframes_ids]
                    answer.candidate_idxs = [self.number(c.keyframe) for c in found]
                    answer.candidate_scores = [c.bow.score if c.bow else 0.0 for c in found]
            except RevisitError as error:
                base.print(f"LoopDetectorRevisit: keyframe {keyframe.id}: {error}")
            return answer

        def name(self, frame_id: int) -> str:
            return f"{self.session}-{frame_id}"

        def number(self, keyframe: str) -> int:
            return int(keyframe[len(self.session) + 1 :])

        def body(self, keyframe: Any) -> dict[str, Any]:
            """Return a keyframe's body. Octaves are whole numbers, and OpenCV's angle is -1 where there is none."""
            seconds, matrix = self.pose_of(keyframe.id)
            descriptors = np.ascontiguousarray(keyframe.des, dtype=np.uint8)
            columns = zip(np.asarray(keyframe.kps, dtype=float), keyframe.octaves, keyframe.angles, strict=True)
            keypoints = [[float(u), float(v), int(o)] + ([float(a)] if a >= 0 else []) for (u, v), o, a in columns]
            body = {"session": self.session, "stamp": _stamp(seconds), "pose": poses.body(np.asarray(matrix, dtype=float)), "camera": self.camera, "features": {
                "descriptor_bytes": int(descriptors.shape[1]), "keypoints": keypoints,
                "descriptors": base64.b64encode(descriptors.tobytes()).decode()}}  # fmt: skip
            if self.words_of is not None:
                body["bow"] = dict(zip(("words", "weights"), self.words_of(keyframe.des), strict=True))
            return body | ({"detections": self.detections_of(keyframe.img)} if self.detections_of is not None else {})

    return Detector(**options)


def _stamp(seconds: float) -> dict[str, int]:
    return dict(zip(("sec", "nanosec"), divmod(round(seconds * 1e9), 1_000_000_000), strict=True))
