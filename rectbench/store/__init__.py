"""The content-addressed store and its keys."""
