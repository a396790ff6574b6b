"""The reports, one file each, with their accepted numbers."""
