"""Detectors of features, and matches of them; no geometry. Imports images and types alone."""
