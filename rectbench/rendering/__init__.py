"""Worlds, the Mitsuba sensor for any camera, images and their truth. Imports warps and what is below."""

from rectbench.rendering import blocks as blocks
