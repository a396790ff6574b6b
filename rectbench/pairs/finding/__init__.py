"""Photographs and calibrations found in a folder. Imports calibrations, images and what is below."""
