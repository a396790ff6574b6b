"""The formats, a file each, found by the registry; imports what lies beside this folder, and below."""
