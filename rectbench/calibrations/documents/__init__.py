"""Files as text and plain data: JSON, YAML, XML, lists of numbers."""
