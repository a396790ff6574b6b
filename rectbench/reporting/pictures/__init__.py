"""Figures of images, maps and points, one file each, and what they are drawn with. Imports what charts do."""
