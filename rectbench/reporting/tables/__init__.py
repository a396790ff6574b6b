"""Tables of a run and their spellings."""
