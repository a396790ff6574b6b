"""Formats of structure from motion, a file each. Imports other formats and what they may."""
