"""The rectifiers, one file each."""
