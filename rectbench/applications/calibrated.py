"""The rig and the images that a request names."""

from __future__ import annotations

from rectbench.applications.requests.photographs import PoseRequest, ReconstructRequest
from rectbench.applications.requests.shared import RigRequest, SizedRigRequest
from rectbench.calibrations import load_rig, load_rig_of_images
from rectbench.images.reading import read_images
from rectbench.rigs import Rig
from rectbench.types import Images


def rig_of(request: RigRequest, images: Images | None = None) -> Rig:
    """The rig of a request, its lenses held to their image circle.

    The images tell a size that the calibration leaves out. Raises what `load_rig` raises.
    """
    if isinstance(request.rig, Rig):
        rig = request.rig
    elif images is not None:
        width, height = images.left.shape[1::-1]
        rig = load_rig_of_images(request.rig, (width, height), request.unit, request.cameras)
    else:
        size = request.size if isinstance(request, SizedRigRequest) else None
        rig = load_rig(request.rig, size, request.unit, request.cameras)
    return rig if request.max_angle_deg is None else rig.within(request.max_angle_deg)


def calibrated_pair(request: PoseRequest | ReconstructRequest) -> tuple[Rig, Images]:
    """The rig of a request, and its two photographs."""
    images = read_images(request.left, request.right)
    return rig_of(request, images), images
