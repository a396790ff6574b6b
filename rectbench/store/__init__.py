"""The content-addressed store and its keys. Imports errors alone."""
