"""What a rectifier, a scene, a metric and a figure are, and the loader of all of them."""
