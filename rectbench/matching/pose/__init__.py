"""The two-view geometry that matches determine. Imports matching.features, rigs and what is below."""
