"""What a run leaves behind: its record and rows, read once; the gate, comparisons, verdicts on claims.

Imports experiments and what is below.
"""
