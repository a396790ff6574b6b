"""The scenes that come with rectbench: one file each, built from `rectbench.blocks` and a seed."""
