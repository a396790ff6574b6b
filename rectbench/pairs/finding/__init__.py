"""Photographs and calibrations found in a folder."""
