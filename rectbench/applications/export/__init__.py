"""A rendered dataset for other tools. Imports the applications beside it and what is below."""
