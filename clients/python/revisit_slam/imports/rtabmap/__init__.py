"""RTAB-Map: its database, and its `rtabmap_msgs/MapData` in a ROS 2 recording."""
