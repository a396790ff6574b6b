"""Calibration boards found in both images: chessboards and tags. Imports images and types alone."""
