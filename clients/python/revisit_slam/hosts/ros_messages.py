"""ROS messages that go out, filled in from links and edges. They are made by the node: this needs no ROS."""

from __future__ import annotations

from typing import Any

import msgspec
import numpy as np

from ..imports.poses import body, matrix
from .loops import Edge, Loop
from .rtabmap import Link

LOOP_CLOSURE = 1
SECOND_NS = 1_000_000_000


def fill_link(message: Any, link: Link) -> Any:
    """Fill in a `rtabmap_msgs/Link`."""
    message.from_id, message.to_id, message.type = link.from_id, link.to_id, link.type
    _fill(message.transform.translation, message.transform.rotation, link.from_from_to)
    message.information = link.information.ravel()
    return message


def fill_edge(message: Any, edge: Edge, robot: int) -> Any:
    """Fill in a `pose_graph_tools_msgs/PoseGraphEdge`: Hydra looks nodes up by the times in its keys, in nanoseconds."""
    message.key_from, message.key_to = edge.stamps_ns
    message.robot_from = message.robot_to = robot
    message.type = LOOP_CLOSURE
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(edge.stamps_ns[0], SECOND_NS)
    _fill(message.pose.position, message.pose.orientation, edge.to_from_from)
    message.covariance = edge.covariance.ravel()
    return message


def told(loop: Loop) -> str:
    """Return a loop as JSON: what it is between, and `candidate_from_query` of the cameras where it is measured."""
    pose = None if loop.candidate_from_query is None else body(loop.candidate_from_query)
    return msgspec.json.encode({"query": loop.query, "candidate": loop.candidate, "candidate_from_query": pose}).decode()


def pose_from_numbers(numbers: Any) -> np.ndarray:
    """Return the pose of a parameter: x, y, z, qx, qy, qz, qw."""
    numbers = [float(number) for number in numbers]
    if len(numbers) != 7:
        raise ValueError(f"{len(numbers)} numbers; a pose is x, y, z, qx, qy, qz, qw")
    return matrix(numbers[:3], numbers[3:], "the pose")


def _fill(position: Any, orientation: Any, pose: np.ndarray) -> None:
    written = body(pose)
    for axis, value in written["translation"].items():
        setattr(position, axis, value)
    for axis, value in written["rotation"].items():
        setattr(orientation, axis, value)
