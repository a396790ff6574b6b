"""What a pair tells without rectification, to compare with. Imports metrics and what is below."""
