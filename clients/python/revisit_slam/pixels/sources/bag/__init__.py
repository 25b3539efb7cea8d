"""Bag: a ROS 2 recording (MCAP or SQLite), or a ROS 1 bag: pictures, their camera, and odometry."""

from .bag import open_bag

__all__ = ["open_bag"]
