"""Lookup tables, and resampling through them."""
