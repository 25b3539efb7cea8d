"""Definitions of the messages of `rtabmap_msgs`, for recordings that do not carry their own (ROS 2, rtabmap_ros at aec4f91)."""

from __future__ import annotations

from functools import cache
from typing import Any

from ...needed import needed

MAP_DATA = "rtabmap_msgs/msg/MapData"
DEFINITIONS = {
    "Point2f": "float32 x\nfloat32 y",
    "Point3f": "float32 x\nfloat32 y\nfloat32 z",
    "KeyPoint": "Point2f pt\nfloat32 size\nfloat32 angle\nfloat32 response\nint32 octave\nint32 class_id",
    "GPS": "float64 stamp\nfloat64 longitude\nfloat64 latitude\nfloat64 altitude\nfloat64 error\nfloat64 bearing",
    "EnvSensor": "std_msgs/Header header\nint32 type\nfloat64 value",
    "GlobalDescriptor": "std_msgs/Header header\nint32 type\nuint8[] info\nuint8[] data",
    "LandmarkDetection": (
        "std_msgs/Header header\nstring landmark_frame_id\nint32 id\nfloat32 size\ngeometry_msgs/PoseWithCovariance pose"
    ),
    "Link": "int32 from_id\nint32 to_id\nint32 type\ngeometry_msgs/Transform transform\nfloat64[36] information",
    "MapGraph": (
        "std_msgs/Header header\ngeometry_msgs/Transform map_to_odom\nint32[] poses_id\ngeometry_msgs/Pose[] poses\nLink[] links"
    ),
    "SensorData": (
        "std_msgs/Header header\nsensor_msgs/Image left\nsensor_msgs/Image right\nuint8[] left_compressed\n"
        "uint8[] right_compressed\nsensor_msgs/CameraInfo[] left_camera_info\nsensor_msgs/CameraInfo[] right_camera_info\n"
        "geometry_msgs/Transform[] local_transform\nsensor_msgs/PointCloud2 laser_scan\nuint8[] laser_scan_compressed\n"
        "int32 laser_scan_max_pts\nfloat32 laser_scan_max_range\nint32 laser_scan_format\n"
        "geometry_msgs/Transform laser_scan_local_transform\nuint8[] user_data\nuint8[] grid_ground\nuint8[] grid_obstacles\n"
        "uint8[] grid_empty_cells\nfloat32 grid_cell_size\nPoint3f grid_view_point\nKeyPoint[] key_points\nPoint3f[] points\n"
        "uint8[] descriptors\nGlobalDescriptor[] global_descriptors\nEnvSensor[] env_sensors\nsensor_msgs/Imu imu\n"
        "geometry_msgs/Transform imu_local_transform\nLandmarkDetection[] landmarks\ngeometry_msgs/Pose ground_truth_pose\nGPS gps"
    ),
    "Node": (
        "int32 id\nint32 map_id\nint32 weight\nfloat64 stamp\nstring label\ngeometry_msgs/Pose pose\nint32[] word_id_keys\n"
        "int32[] word_id_values\nKeyPoint[] word_kpts\nPoint3f[] word_pts\nuint8[] word_descriptors\nSensorData data"
    ),
    "MapData": "std_msgs/Header header\nMapGraph graph\nNode[] nodes",
    "Info": (
        "std_msgs/Header header\nint32 ref_id\nint32 loop_closure_id\nint32 proximity_detection_id\nint32 landmark_id\n"
        "geometry_msgs/Transform loop_closure_transform\nint32[] wm_state\nint32[] posterior_keys\nfloat32[] posterior_values\n"
        "int32[] likelihood_keys\nfloat32[] likelihood_values\nint32[] raw_likelihood_keys\nfloat32[] raw_likelihood_values\n"
        "int32[] weights_keys\nint32[] weights_values\nint32[] labels_keys\nstring[] labels_values\nstring[] stats_keys\n"
        "float32[] stats_values\nint32[] local_path\nint32 current_goal_id\nMapGraph odom_cache"
    ),
}


@cache
def typestore() -> Any:
    """Return the store of message types of ROS 2, and of `rtabmap_msgs`; it is not to be changed."""
    typesys = needed("rosbags.typesys", "rosbags")
    store = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE)
    types: dict[str, Any] = {}
    for name, text in DEFINITIONS.items():
        types.update(typesys.get_types_from_msg(text, f"rtabmap_msgs/msg/{name}"))
    store.register(types)
    return store
