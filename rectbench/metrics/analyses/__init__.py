"""What is told of a rectification beside its metrics: its frame's costs, how sure it is. Imports metrics."""
