"""Figures of images and points."""
