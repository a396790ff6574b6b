"""Formats of visual odometry and of its calibrators."""
