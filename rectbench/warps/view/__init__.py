"""What of a view is shown: angles, frames, pixels that are looked at. Imports warps and what is below."""
