"""The record of a run, its rows, the gate and comparisons. Imports experiments and what is below."""
