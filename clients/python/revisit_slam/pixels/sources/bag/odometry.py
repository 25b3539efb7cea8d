"""Odometry of a recording, as where the camera was."""

from __future__ import annotations

import numpy as np

from ....imports.bag import Bag
from ...trajectory import Trajectory
from .transforms import StaticTransforms

ODOMETRY = "nav_msgs/msg/Odometry"
TF = "tf2_msgs/msg/TFMessage"


def odometry_of(recording: Bag, named: str | None, camera_frame: str) -> tuple[Trajectory | None, str]:
    """Return the camera's way and its topic; or None, and why there is none."""
    topic = recording.one("--odometry-topic", named, (ODOMETRY,))
    if topic is None:
        return None, f"no {ODOMETRY} in it"
    poses, base = [], ""
    for stamp_ns, message in recording.messages(topic):
        base = message.child_frame_id
        p, q = message.pose.pose.position, message.pose.pose.orientation
        translation, quaternion = np.array([p.x, p.y, p.z]), np.array([q.x, q.y, q.z, q.w])
        # Not `<`: a quaternion that is no number is below nothing.
        if np.linalg.norm(quaternion) > 1e-6 and np.isfinite(translation).all():
            poses.append((stamp_ns, translation, quaternion))
    transforms = StaticTransforms()
    for static in recording.topics(TF):
        if static.endswith("tf_static"):
            for _, message in recording.messages(static):
                transforms.add(message)
    base_from_camera = transforms.between(base, camera_frame)
    if base_from_camera is None:
        moves = base or "a frame without a name"
        return None, f"odometry on {topic} is that of {moves}, and nothing on /tf_static joins it to the camera's {camera_frame}"
    return Trajectory(f"{recording.file} {topic}", poses, base_from_camera), topic
