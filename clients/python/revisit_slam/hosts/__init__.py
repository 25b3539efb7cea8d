"""Hosts: live SLAM systems that send keyframes and take loops back, without ever waiting for a server."""
