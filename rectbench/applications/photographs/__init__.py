"""Photographs of one rig rectified into a folder. Imports the applications beside it and what is below."""
