"""Which method serves where nobody names one."""

DEFAULT_METHOD = "local-homography"
UNCALIBRATED_METHOD = "hartley"
"""For images without a calibration."""
