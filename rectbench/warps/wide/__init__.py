"""Targets of wide views whose columns or rows hang on both angles. Imports `warps.targets` and below."""
