"""Pictures as they come: the pair of a rig, reading, grey and RGB of 8 bits."""
