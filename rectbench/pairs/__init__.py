"""The pair under a cell: rendered or photographed, and all that is known of it. Imports metrics and below."""
