"""The projection models, one a file, each registered when imported. Imports files of cameras and formulas."""

from rectbench.cameras.models import (  # noqa: F401
    cahvor,
    division,
    double_sphere,
    equidistant,
    equisolid,
    extended_unified,
    field_of_view,
    fisheye624,
    kannala_brandt,
    orthographic,
    pinhole,
    stereographic,
    thin_prism_fisheye,
    unified,
)
from rectbench.cameras.models.in_pixels import f_theta, ocam  # noqa: F401
