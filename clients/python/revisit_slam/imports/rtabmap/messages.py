"""Messages of `rtabmap_msgs`, decoded by rosbags or received by rclpy: both have the same attributes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ...errors import RevisitError
from ...pixels.pinhole import Pinhole
from ..damage import Account
from ..limits import MAX_FEATURES, MAX_KEYFRAMES
from ..observation import Observation
from ..poses import matrix
from .blobs import matrix_of
from .node import ASSUMED_SIDE_M, LANDMARK, Landmarks, Mounted, Words, observation, usable_descriptors

MAX_NODE_ID = 2**31 - 1


@dataclass(frozen=True, eq=False)
class Graph:
    """An optimised graph: `map_from_base` by node, links of nodes as (from, to, type), and where odometry's frame is in the map."""

    poses: dict[int, np.ndarray]
    links: list[tuple[int, int, int]]
    map_from_odom: np.ndarray
    landmarks: dict[int, Landmarks]


def graph_of(message: Any, account: Account, where: str) -> Graph:
    """Return the graph of a `MapGraph`; a pose or a link that is wrong is left out."""
    ids = [int(id) for id in message.poses_id]
    if len(ids) != len(message.poses) or len(ids) > MAX_KEYFRAMES:
        raise RevisitError(f"{where}: its graph has {len(message.poses)} poses for {len(ids)} nodes")
    # RTAB-Map writes landmarks as nodes with negative numbers.
    poses: dict[int, np.ndarray] = {}
    for id, pose in zip(ids, message.poses):
        if id > 0:
            with account.part(f"the graph's pose of node {id}") as part:
                poses[id] = pose_of(pose, part)
    links: list[tuple[int, int, int]] = []
    landmarks: dict[int, Landmarks] = {}
    for link in message.links:
        one, other, kind = int(link.from_id), int(link.to_id), int(link.type)
        if kind == LANDMARK and one > 0 > other:
            with account.part(f"the link from {one} to {other}") as part:
                landmarks.setdefault(one, []).append((other, transform_of(link.transform, part), ASSUMED_SIDE_M))
        elif one > 0 and other > 0:
            links.append((one, other, kind))
    return Graph(poses, links, transform_of(message.map_to_odom, f"{where}: map_to_odom"), landmarks)


def pose_of(message: Any, where: str) -> np.ndarray:
    """Return a `geometry_msgs/Pose`."""
    return _matrix(message.position, message.orientation, where)


def transform_of(message: Any, where: str) -> np.ndarray:
    """Return a `geometry_msgs/Transform`."""
    return _matrix(message.translation, message.rotation, where)


def camera_of(info: Any, where: str) -> Pinhole | None:
    """Return the camera of a `sensor_msgs/CameraInfo` whose pictures are rectified; None where it is not calibrated."""
    k, p, width, height = info.k, info.p, int(info.width), int(info.height)
    fx, fy, cx, cy = (p[0], p[5], p[2], p[6]) if p[0] else (k[0], k[4], k[2], k[5])
    return Pinhole(float(fx), float(fy), float(cx), float(cy), width, height).checked(where) if fx and width and height else None


def observation_of(node: Any, graph: Graph, name: str, where: str) -> Observation | None:
    """Return a node's observation; `where` names it. None where it is none: without a pose, or between keyframes."""
    id = int(node.id)
    if not 0 < id <= MAX_NODE_ID:
        raise RevisitError(f"{where}: that is no node's number")
    if node.weight < 0:
        return None
    map_from_base = graph.poses.get(id)
    if map_from_base is None:
        # RTAB-Map's null is a quaternion of zeros.
        if not any(getattr(node.pose.orientation, axis) for axis in "xyzw"):
            return None
        map_from_base = graph.map_from_odom @ pose_of(node.pose, where)
    mounted, words = _mounted(node.data, where), words_of(node, where)
    return observation(f"{name}-{int(node.map_id)}", id, node.stamp, map_from_base, mounted, words, graph.landmarks.get(id, []))


def words_of(node: Any, where: str) -> Words:
    """Return the words of a node; `word_id_values` says which keypoint is of which word."""
    keys, at = np.asarray(node.word_id_keys, np.int64), np.asarray(node.word_id_values, np.int64)
    count = len(keys)
    if count > MAX_FEATURES:
        raise RevisitError(f"{where} has {count} words; at most {MAX_FEATURES} are taken")
    if len(at) != count or not np.array_equal(np.sort(at), np.arange(count)):
        raise RevisitError(f"{where}: its words are not numbered")
    ids = np.empty(count, np.int64)
    ids[at] = keys
    keypoints = list(node.word_kpts)
    points = np.array([(p.x, p.y, p.z) for p in node.word_pts], float).reshape(-1, 3)
    if len(keypoints) not in (0, count) or len(points) not in (0, count):
        raise RevisitError(f"{where} has {count} words, {len(keypoints)} keypoints and {len(points)} points")
    rows = matrix_of(bytes(node.word_descriptors), where) if len(node.word_descriptors) else None
    descriptors = usable_descriptors(rows) if keypoints else None
    if descriptors is not None and len(descriptors) != count:
        raise RevisitError(f"{where} has {count} words and {len(descriptors)} descriptors")
    return Words(
        ids,
        np.array([(k.pt.x, k.pt.y) for k in keypoints], np.float32).reshape(-1, 2),
        np.array([k.octave for k in keypoints], np.int64),
        np.array([k.angle for k in keypoints], np.float32),
        points if len(points) else np.full((count, 3), np.nan),
        descriptors,
    )


def _mounted(data: Any, where: str) -> Mounted:
    infos, places = list(data.left_camera_info), list(data.local_transform)
    if len(places) != len(infos):
        raise RevisitError(f"{where} has {len(infos)} cameras, and places for {len(places)}")
    if not infos:
        return Mounted(None, np.eye(4))
    return Mounted(camera_of(infos[0], where), transform_of(places[0], f"{where}: the camera's place on the base"), len(infos))


def _matrix(position: Any, orientation: Any, where: str) -> np.ndarray:
    xyzw = (orientation.x, orientation.y, orientation.z, orientation.w)
    return matrix((position.x, position.y, position.z), xyzw, where)
