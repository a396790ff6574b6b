"""What verbs take, stated once for Python and the command line: a model a verb. Imports errors alone,
so that `rectbench --help` is quick: no NumPy here."""
