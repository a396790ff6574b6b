"""Dense disparity and the points it gives."""
