"""A rendered dataset for other tools."""
