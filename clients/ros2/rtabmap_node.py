#!/usr/bin/env python3
"""ROS 2 node: RTAB-Map's nodes go to Revisit, and the loops that Revisit finds come back as links.

    python3 rtabmap_node.py --ros-args -p server:=http://127.0.0.1:7878 -p map:=office -p name:=robot-7

In: `mapData` (rtabmap_msgs/MapData), `info` (rtabmap_msgs/Info). Back: the service `add_link` (rtabmap_msgs/srv/AddLink), or the
topic `external_loop_closures` (pose_graph_tools_msgs/PoseGraph), or both (`-p back:=both`).
"""

from __future__ import annotations

import json
from collections import deque
from typing import Any

import rclpy
from rclpy.node import Node
from rtabmap_msgs.msg import Info, Link, MapData
from rtabmap_msgs.srv import AddLink

from revisit_slam import Client
from revisit_slam.hosts.bridge import Bridge
from revisit_slam.hosts.loops import Trust
from revisit_slam.hosts.ros_messages import fill_edge, fill_link
from revisit_slam.hosts.rtabmap import RtabmapBridge

BACK = ("add_link", "pose_graph", "both")
PERIOD_S = 0.05
TOLD_EVERY_S = 10.0
LINKS = 256


class RevisitRtabmap(Node):
    """Joins one RTAB-Map and one map of a Revisit server."""

    def __init__(self) -> None:
        super().__init__("revisit_rtabmap")

        def parameter(name: str, default):
            return self.declare_parameter(name, default).value

        self.back = parameter("back", "add_link")
        if self.back not in BACK:
            raise ValueError(f"back:={self.back}: one of {', '.join(BACK)}")
        self.robot = parameter("robot", 0)
        trust = Trust(parameter("translation_std_m", 0.05), parameter("rotation_std_rad", 0.02))
        self.client = Client(parameter("server", "http://127.0.0.1:7878"), key=parameter("key", "") or None)
        # Loops need a transform here, and RTAB-Map's maps may have no signs: geometry alone may decide.
        settings = json.loads(parameter("settings", '{"without_anchors": "geometry"}'))
        self.bridge = Bridge(self.client, parameter("map", "rtabmap"), settings=settings, verify=parameter("verify", "geometry"))
        self.rtabmap = RtabmapBridge(self.bridge, parameter("name", "rtabmap"), trust)
        self.create_subscription(MapData, "mapData", self.rtabmap.on_map_data, 10)
        self.create_subscription(Info, "info", self.rtabmap.on_info, 10)
        self.waiting: deque[Any] = deque(maxlen=LINKS)
        self.add_link = self.create_client(AddLink, "add_link") if self.back != "pose_graph" else None
        self.graphs = None
        if self.back != "add_link":
            from pose_graph_tools_msgs.msg import PoseGraph

            self.graphs = self.create_publisher(PoseGraph, "external_loop_closures", 10)
        self.create_timer(PERIOD_S, self.give_back)
        self.create_timer(TOLD_EVERY_S, self.tell)

    def give_back(self) -> None:
        """Hand the loops found since the last time to RTAB-Map. Nothing is waited for."""
        for link in self.rtabmap.take_links():
            self.waiting.append(link)
            if self.graphs is not None:
                from pose_graph_tools_msgs.msg import PoseGraph, PoseGraphEdge

                graph = PoseGraph(edges=[fill_edge(PoseGraphEdge(), link.edge, self.robot)])
                graph.header.stamp = graph.edges[0].header.stamp
                self.graphs.publish(graph)
        # While RTAB-Map is away its links wait; the oldest are dropped.
        while self.add_link is not None and self.waiting and self.add_link.service_is_ready():
            # The answer is empty; whether the link was taken, the next MapData tells.
            self.add_link.call_async(AddLink.Request(link=fill_link(Link(), self.waiting.popleft())))

    def tell(self) -> None:
        """Say how far behind the server is, where it is."""
        stats = self.bridge.stats()
        if stats.unreachable or stats.dropped or self.bridge.dropped:
            self.get_logger().warning(
                f"{stats.queued + stats.spilled} keyframes wait ({stats.lag_s:.0f} s behind), {stats.dropped} dropped, "
                f"{self.bridge.dropped} messages or requests dropped or failed"
            )

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
    node = RevisitRtabmap()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
