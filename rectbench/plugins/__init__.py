"""Contracts of rectifiers, scenes, metrics and figures, and what these get. Imports rendering and below."""
