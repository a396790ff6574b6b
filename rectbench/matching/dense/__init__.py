"""Dense disparity and the points it gives. Imports warps, images and what is below."""
