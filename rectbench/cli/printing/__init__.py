"""What the command line prints, one file a concern: tables for a person to read. Imports what it shows."""
