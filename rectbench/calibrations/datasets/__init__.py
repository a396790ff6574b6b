"""Formats of public datasets."""
