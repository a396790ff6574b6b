"""The projection models, one a file; importing this package registers them all."""

from rectbench.cameras.models import (
    double_sphere,
    equidistant,
    equisolid,
    extended_unified,
    field_of_view,
    kannala_brandt,
    ocam,
    orthographic,
    pinhole,
    stereographic,
    unified,
)

__all__ = [
    "double_sphere",
    "equidistant",
    "equisolid",
    "extended_unified",
    "field_of_view",
    "kannala_brandt",
    "ocam",
    "orthographic",
    "pinhole",
    "stereographic",
    "unified",
]
