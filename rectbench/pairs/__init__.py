"""The pair under a cell: rendered or photographed, with all that is known of it."""
