"""The page of a run, and what it says of the run itself. Imports figures and tables."""
