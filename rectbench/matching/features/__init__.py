"""Features, and matches of them."""
