"""Figures of numbers, one file each, and the bars they share. Imports plugins, pictures, style and names."""
