"""Definitions of the ROS 2 messages that the nodes of `clients/ros2` use and rosbags does not have."""

DEFINITIONS = {
    "pose_graph_tools_msgs/msg/PoseGraphNode": "std_msgs/Header header\nint32 robot_id\nuint64 key\ngeometry_msgs/Pose pose",
    "pose_graph_tools_msgs/msg/PoseGraphEdge": (
        "std_msgs/Header header\nuint64 key_from\nuint64 key_to\nint32 robot_from\nint32 robot_to\nint32 type\n"
        "int32 ODOM=0\nint32 LOOPCLOSE=1\nint32 LANDMARK=2\nint32 REJECTED_LOOPCLOSE=3\nint32 MESH=4\nint32 POSE_MESH=5\n"
        "int32 MESH_POSE=6\ngeometry_msgs/Pose pose\nfloat64[36] covariance"
    ),
    "pose_graph_tools_msgs/msg/PoseGraph": "std_msgs/Header header\nPoseGraphNode[] nodes\nPoseGraphEdge[] edges",
    "vision_msgs/msg/Point2D": "float64 x\nfloat64 y",
    "vision_msgs/msg/Pose2D": "Point2D position\nfloat64 theta",
    "vision_msgs/msg/BoundingBox2D": "vision_msgs/Pose2D center\nfloat64 size_x\nfloat64 size_y",
    "vision_msgs/msg/ObjectHypothesis": "string class_id\nfloat64 score",
    "vision_msgs/msg/ObjectHypothesisWithPose": "ObjectHypothesis hypothesis\ngeometry_msgs/PoseWithCovariance pose",
    "vision_msgs/msg/Detection2D": (
        "std_msgs/Header header\nObjectHypothesisWithPose[] results\nBoundingBox2D bbox\nstring id"
    ),
    "vision_msgs/msg/Detection2DArray": "std_msgs/Header header\nDetection2D[] detections",
}
