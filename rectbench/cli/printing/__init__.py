"""What the command line prints for a person to read, a file for each file of verbs. Imports what it shows."""
