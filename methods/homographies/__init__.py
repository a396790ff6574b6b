"""One homography an image, of what a perspective camera sees; a fisheye image is undistorted first."""
