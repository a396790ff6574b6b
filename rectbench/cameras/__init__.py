"""Φ, pixel ↔ ray: one `Camera`, its lens and derivatives. Imports formulas and what is below."""

from rectbench.cameras.camera import Camera as Camera
from rectbench.cameras.cones import Cones as Cones
from rectbench.cameras.projection import Projection as Projection
