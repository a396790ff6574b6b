"""Plan → run → store → gate: reports, cells, the store they are kept in, and plugin loading."""
