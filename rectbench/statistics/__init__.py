"""What numbers decide: intervals, ranks and designs, from arrays and mappings alone."""
