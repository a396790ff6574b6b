"""Formats of cameras and their drivers, a file each. Imports other formats and what they may."""
