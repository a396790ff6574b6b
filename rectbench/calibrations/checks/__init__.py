"""What is said of a calibration beside the rig: what was not read, disagrees, is improbable, or unknown."""
