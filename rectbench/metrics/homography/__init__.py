"""What papers on rectifying homographies measure, if a report asks for it. Imports metrics and below."""
