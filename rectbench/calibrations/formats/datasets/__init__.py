"""Formats of public datasets, a file each. Imports other formats and what they may."""
