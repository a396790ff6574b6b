"""What tools and papers make of wide lenses: fixed maps with nothing to fit, and controls."""
