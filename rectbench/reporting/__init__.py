"""What reads a finished run: its tables, figures and page. Imports runs and what is below."""
