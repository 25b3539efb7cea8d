#!/usr/bin/env python3
"""ROS 2 node: any SLAM's poses, pictures and detections go to Revisit, and the loops that it finds come back as a pose graph.

    python3 observations_node.py --ros-args -p server:=http://127.0.0.1:7878 -p map:=office -p session:=robot-7-monday

In: `pose` (geometry_msgs/PoseStamped), `image` (sensor_msgs/Image, undistorted), `camera_info` (sensor_msgs/CameraInfo),
`detections` (vision_msgs/Detection2DArray), and with `-p depth:=true` `depth` (sensor_msgs/Image, registered). Back: each loop
on `loops` (std_msgs/String, JSON), and those whose transform is measured on `external_loop_closures`
(pose_graph_tools_msgs/PoseGraph).
"""

from __future__ import annotations

import json

import rclpy
from geometry_msgs.msg import PoseStamped
from pose_graph_tools_msgs.msg import PoseGraph, PoseGraphEdge
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import CameraInfo, Image
from std_msgs.msg import String
from vision_msgs.msg import Detection2DArray

from revisit_slam import Client
from revisit_slam.hosts.bridge import Bridge
from revisit_slam.hosts.loops import Trust
from revisit_slam.hosts.observations import ObservationsBridge, Setup
from revisit_slam.hosts.ros_messages import fill_edge, pose_from_numbers, told
from revisit_slam.hosts.sightings import Reading

PERIOD_S = 0.05
TOLD_EVERY_S = 10.0


class RevisitObservations(Node):
    """Joins one robot and one map of a Revisit server."""

    def __init__(self) -> None:
        super().__init__("revisit_observations")

        def parameter(name: str, default):
            return self.declare_parameter(name, default).value

        self.robot = parameter("robot", 0)
        setup = Setup(
            session=parameter("session", "default"),
            base_from_camera=pose_from_numbers(parameter("base_from_camera", [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0])),
            slop_s=parameter("slop_s", 0.05),
            keyframe_distance_m=parameter("keyframe_distance_m", 0.25),
            keyframe_turn_rad=parameter("keyframe_turn_rad", 0.26),
            reading=Reading(parameter("text_from", "crop"), parameter("assumed_distance_m", 3.0)),
            trust=Trust(parameter("translation_std_m", 0.05), parameter("rotation_std_rad", 0.02)),
            has_depth=parameter("depth", False),
            describe=self.describer() if parameter("features", True) else None,
        )
        self.client = Client(parameter("server", "http://127.0.0.1:7878"), key=parameter("key", "") or None)
        settings = json.loads(parameter("settings", "{}"))
        self.bridge = Bridge(self.client, parameter("map", "robots"), settings=settings, verify=parameter("verify", "auto"))
        self.observations = ObservationsBridge(self.bridge, setup)
        self.create_subscription(PoseStamped, "pose", self.observations.on_pose, 50)
        self.create_subscription(Image, "image", self.observations.on_image, qos_profile_sensor_data)
        self.create_subscription(CameraInfo, "camera_info", self.observations.on_camera_info, qos_profile_sensor_data)
        self.create_subscription(Detection2DArray, "detections", self.observations.on_detections, 10)
        if setup.has_depth:
            self.create_subscription(Image, "depth", self.observations.on_depth, qos_profile_sensor_data)
        self.loops = self.create_publisher(String, "loops", 10)
        self.graphs = self.create_publisher(PoseGraph, "external_loop_closures", 10)
        self.create_timer(PERIOD_S, self.give_back)
        self.create_timer(TOLD_EVERY_S, self.tell)

    def describer(self):
        """Return what makes words and features of a picture; None without OpenCV."""
        try:
            from revisit_slam.hosts.describing import Describer
        except ImportError:
            self.get_logger().warning("without OpenCV (revisit-slam[read]) no words and features are sent: only signs propose loops")
            return None
        return Describer()

    def give_back(self) -> None:
        """Publish the loops found since the last time. Nothing is waited for."""
        for loop, edge in self.observations.take_loops():
            self.loops.publish(String(data=told(loop)))
            if edge is None:
                continue
            graph = PoseGraph(edges=[fill_edge(PoseGraphEdge(), edge, self.robot)])
            graph.header.stamp = graph.edges[0].header.stamp
            self.graphs.publish(graph)

    def tell(self) -> None:
        """Say how far behind the server is, and what is missing."""
        stats = self.bridge.stats()
        if stats.unreachable or stats.dropped or self.bridge.dropped:
            self.get_logger().warning(
                f"{stats.queued + stats.spilled} keyframes wait ({stats.lag_s:.0f} s behind), {stats.dropped} dropped, "
                f"{self.bridge.dropped} messages or requests dropped or failed"
            )
        if self.observations.without_camera:
            self.get_logger().warning(f"{self.observations.without_camera} moments came before any camera_info, and were left out")
        if self.bridge.without_transform:
            self.get_logger().info(f"{self.bridge.without_transform} loops by signs alone have no transform, and were not published")

    def destroy_node(self) -> None:
        """Send what is left, for a moment."""
        left = self.bridge.close(timeout_s=5.0)
        if left:
            self.get_logger().warning(f"{left} keyframes were not sent")
        self.client.close()
        super().destroy_node()


def main() -> None:
    """Run the node until it is stopped."""
    rclpy.init()
    node = RevisitObservations()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
