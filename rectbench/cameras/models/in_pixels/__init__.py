"""Lenses whose radius is in pixels, on a stretched sensor. Imports files of cameras and formulas."""
