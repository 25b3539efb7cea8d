"""The detector for pySLAM, on stand-ins with the members of its classes, against the running server."""

from __future__ import annotations

from enum import Enum
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from revisit_slam import Client, Server
from revisit_slam.imports import poses
from revisit_slam.pyslam import LoopDetectorRevisit

CAMERA = {"fx": 525.0, "fy": 525.0, "cx": 320.0, "cy": 240.0, "width": 640, "height": 480}


class Kind(Enum):
    COMPUTE_GLOBAL_DES = 2
    LOOP_CLOSURE = 3
    RELOCALIZATION = 4


class Base:
    print = staticmethod(lambda *args: Base.said.append(args[0]))
    said: list[str] = []

    def __init__(self) -> None:
        self.entry_id = 0


class Output:
    def __init__(self, task_type: Kind, frame_id: int, img: Any) -> None:
        self.task_type, self.frame_id, self.img = task_type, frame_id, img
        self.candidate_idxs: list[int] = []
        self.candidate_scores: list[float] = []


def task(frame_id: int, plate: str, kind: Kind = Kind.LOOP_CLOSURE, connected: tuple[int, ...] = ()) -> Any:
    chance = np.random.default_rng(frame_id)
    data = SimpleNamespace(
        id=frame_id, kps=chance.uniform(0, 480, (40, 2)).astype(np.float32), octaves=chance.integers(0, 8, 40),
        angles=np.where(np.arange(40) % 2, 90.0, -1.0), des=chance.integers(0, 256, (40, 32)).astype(np.uint8), img=plate,
    )  # fmt: skip
    return SimpleNamespace(keyframe_data=data, task_type=kind, connected_keyframes_ids=list(connected))


def detector(client: Client) -> Any:
    def pose_of(frame_id: int) -> tuple[float, Any]:
        pose = np.eye(4)
        pose[0, 3] = frame_id % 7
        return frame_id * 10.0, pose

    def detections_of(plate: str) -> list[dict[str, Any]]:
        return [{"class": "door_number", "confidence": 0.9, "box": [300, 200, 340, 220], "position": [2, 0, 2], "text": plate}]

    return LoopDetectorRevisit(
        Base, Output, client, "tower", pose_of=pose_of, camera=CAMERA, detections_of=detections_of,
        words_of=lambda _: ([3, 17, 42], [1.0, 1.0, 1.0]),
    )  # fmt: skip


def test_it_returns_the_loop_and_not_the_twin() -> None:
    with Server() as server, Client(server.url) as client:
        client.put_map("tower", {})
        loops = detector(client)
        assert isinstance(loops, Base)
        assert loops.run_task(task(2, "901")).candidate_idxs == []
        assert loops.run_task(task(20, "910", Kind.COMPUTE_GLOBAL_DES)).candidate_idxs == []
        found = loops.run_task(task(30, "901"))
        assert found.candidate_idxs == [2]
        assert found.candidate_scores == [pytest.approx(1.0)]
        assert found.frame_id == 30
        # What pySLAM has connected already is no candidate.
        assert loops.run_task(task(31, "901", connected=(2, 30))).candidate_idxs == []
        assert client.get_map("tower").keyframes == loops.entry_id == 4
        # A lost frame is not stored.
        assert loops.run_task(task(40, "901", Kind.RELOCALIZATION)).candidate_idxs == []
        assert client.get_map("tower").keyframes == 4


def test_a_server_that_is_away_costs_candidates_and_nothing_else() -> None:
    from revisit_slam.retries import Retries

    with Client("http://127.0.0.1:9", retries=Retries(total_s=0)) as client:
        assert detector(client).run_task(task(2, "901")).candidate_idxs == []
    assert "keyframe 2" in Base.said[-1]


def test_a_matrix_becomes_its_quaternion() -> None:
    chance = np.random.default_rng(7)
    for _ in range(200):
        q = chance.normal(size=4)
        q /= np.linalg.norm(q)
        x, y, z, w = q
        turned = np.eye(4)
        turned[:3, :3] = [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
        found = np.array([poses.body(turned)["rotation"][axis] for axis in "xyzw"])
        assert abs(found @ q) == pytest.approx(1.0, abs=1e-9)
