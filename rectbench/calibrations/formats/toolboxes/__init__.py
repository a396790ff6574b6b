"""Formats of calibration tools, a file each. Imports other formats and what they may."""
