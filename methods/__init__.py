"""The rectifiers, one file each, by what they take for the image of a camera."""
