"""Figures of images, maps and points, one file each, and what they share. Imports plugins and style."""
