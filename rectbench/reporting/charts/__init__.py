"""Figures of numbers, one file each. Imports plugins, style, names and labels; no other part of a report."""
