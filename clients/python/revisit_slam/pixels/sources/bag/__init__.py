"""Bags of ROS as sources."""
