"""Files as text and plain data: JSON, YAML, XML, lists of numbers. Imports `rigs.rig` and what is below."""
