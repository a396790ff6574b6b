"""Photographs as arrays: the pair of a rig, reading, 8-bit grey. Imports rigs and what is below."""
