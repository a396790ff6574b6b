"""Φ, pixel ↔ ray: one file a projection model, one `Camera`."""

from rectbench.cameras.camera import Camera
from rectbench.cameras.projection import Projection

__all__ = ["Camera", "Projection"]
