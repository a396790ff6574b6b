"""Formats of structure from motion."""
