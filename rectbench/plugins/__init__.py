"""Contracts of rectifiers and scenes, what a third party fills in. Imports rendering, warps and below."""
