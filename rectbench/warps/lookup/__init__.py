"""Lookup tables, and resampling through them. Imports warps.warp, formulas and what is below."""
