"""What is done for one rig or folder: rectify, reconstruct, export, check. Imports all but api and cli."""
