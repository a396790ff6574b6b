"""One made-up rig in every calibration format, each text written from the format's own documentation.

Two lenses differ in every number, the pose turns about all three axes, and the body that some formats
refer to stands askew, so that no transposed, inverted or swapped reading can pass.
"""

from tests.calibrations.examples import (
    datasets,
    devices,
    exports,
    fisheye_dialects,
    odometry,
    photogrammetry,
    toolboxes,
    vehicles,
)
from tests.calibrations.examples.datasets import ros_text
from tests.calibrations.examples.made_up import (
    FISHEYES,
    FOCAL1,
    PINHOLES,
    RATIONALS,
    SIZE,
    UNIFIEDS,
    Example,
    matrix_block,
)
from tests.calibrations.examples.toolboxes import AFFINE1, POLY1, ocam_camera

EXAMPLES: dict[str, Example] = {
    **odometry.EXAMPLES,
    **toolboxes.EXAMPLES,
    **datasets.EXAMPLES,
    **exports.EXAMPLES,
    **devices.EXAMPLES,
    **photogrammetry.EXAMPLES,
    **vehicles.EXAMPLES,
    **fisheye_dialects.EXAMPLES,
}
"""By the name of the format, with what tells its variants apart."""

__all__ = [
    "AFFINE1",
    "EXAMPLES",
    "FISHEYES",
    "FOCAL1",
    "PINHOLES",
    "POLY1",
    "RATIONALS",
    "SIZE",
    "UNIFIEDS",
    "Example",
    "matrix_block",
    "ocam_camera",
    "ros_text",
]
