"""What is done for one rig or one folder: choose, rectify, check, examine."""
