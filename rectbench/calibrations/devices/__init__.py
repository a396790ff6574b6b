"""Formats of cameras and their drivers."""
