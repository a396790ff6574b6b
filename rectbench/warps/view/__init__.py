"""What of a view is shown: angles, frames, the pixels that are looked at."""
