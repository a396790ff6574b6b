"""Reports, their claims, plans and cells. Imports pairs, metrics and what is below."""
