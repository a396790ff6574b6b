"""Which method serves where nobody names one."""

DEFAULT_METHOD = "local-homography"
UNCALIBRATED_METHOD = "hartley"
"""For images without a calibration."""

CONTENDERS = (
    *("optimal", "polar-optimal", "local-homography", "abraham", "conventional"),
    *("fusiello", "hartley"),
)
"""Of the built-in methods, those among which the best is looked for: the others make the same maps as one of
these, show what some tool ships, or are controls. Methods of one's own are looked at too."""
