"""Formats of visual odometry and its calibrators, a file each. Imports other formats and what they may."""
