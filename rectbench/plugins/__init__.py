"""Contracts of rectifiers, scenes, metrics and figures, and what these are handed. Imports rendering and below."""
