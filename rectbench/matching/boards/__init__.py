"""Calibration boards found in both images."""
