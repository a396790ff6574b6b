"""Worlds and what they are built from, the Mitsuba sensor for any camera, images and their truth."""

from rectbench.rendering import blocks

__all__ = ["blocks"]
