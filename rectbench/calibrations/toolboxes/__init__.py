"""Formats of calibration tools."""
