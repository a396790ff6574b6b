"""A camera of Isaac Sim, the JSON of Replicator's `camera_params` annotator, one file a camera.

`cameraViewTransform` takes rows [X 1] of the world to the camera, x right, y up, z back, in scene units of
`metersPerSceneUnit`. A `cameraModel` fisheyePolynomial has `cameraFisheyePolynomial`, the angle by powers
of the distance in pixels of the nominal image `cameraFisheyeNominalWidth` x `Height`, about
`cameraFisheyeOpticalCentre`, and `cameraFisheyeMaxFOV`, degrees across; pinhole has a `cameraFocalLength`
on a `cameraAperture`, whose pixels are square. The image reaches from 0 to its size, so (0.5, 0.5) is the
centre of the top-left pixel. Other models of Isaac Sim, and an aperture that is shifted, are refused.
"""

from __future__ import annotations

import numpy as np

from rectbench.calibrations.assembling import camera_of, inverse
from rectbench.calibrations.contract import CameraFormat, Given, PosedCamera
from rectbench.calibrations.documents import Section, Source, agreed_size, errors_at, tell
from rectbench.calibrations.formats.named_cameras import Y_UP_Z_BACK
from rectbench.calibrations.formats.vehicles.f_theta_keys import f_theta_camera
from rectbench.cameras import Camera
from rectbench.errors import InvalidInput
from rectbench.rigs.rig import checked_rotation
from rectbench.types import FloatArray

POLYNOMIAL = "cameraFisheyePolynomial"
VIEW = "cameraViewTransform"
NOMINAL = ("cameraFisheyeNominalWidth", "cameraFisheyeNominalHeight")
OFFSET = "cameraApertureOffset"
RESOLUTION = "renderProductResolution"
UNIT = "metersPerSceneUnit"
MAX_COEFFICIENTS = 12

OF_OTHERS = {
    "pinhole": ("cameraFisheye*", "cameraOpenCV*"),
    "fisheyePolynomial": ("cameraFocalLength", "cameraAperture*", "cameraFisheyeLens*", "cameraOpenCV*"),
}
"""What is written with each model and says nothing of it, as it is of another one."""


def read_posed(source: Source, given: Given) -> PosedCamera:
    """The camera in the file, posed in the scene, metres."""
    file = source.document
    size = agreed_size(file.at(RESOLUTION), file.numbers(RESOLUTION, "[width, height]", 2), given.size)
    kind = file.choice("cameraModel", ("pinhole", "fisheyePolynomial"))
    file.knows(*OF_OTHERS[kind])
    camera = _pinhole(file, size) if kind == "pinhole" else _fisheye(file, size)
    return PosedCamera(source.path, camera, _pose(file))


def _fisheye(file: Section, size: tuple[int, int]) -> Camera:
    nominal = tuple(file.number(key, "pixels") for key in NOMINAL)
    scale = size[0] / nominal[0] if nominal[0] > 0 else 0.0
    if not scale > 0 or abs(nominal[1] * scale - size[1]) > 0.5:
        raise InvalidInput(
            f"{file.at(NOMINAL[0])} and Height are {nominal[0]:g}x{nominal[1]:g}; expected the proportions "
            f"of the image, {size[0]}x{size[1]}"
        )
    poly = file.array(POLYNOMIAL, "a polynomial's coefficients", range(1, MAX_COEFFICIENTS))
    u, v = file.numbers("cameraFisheyeOpticalCentre", "two pixels", 2)
    fov = file.number("cameraFisheyeMaxFOV", "degrees, 0 where the image ends the view")
    scaled = (poly / scale ** np.arange(len(poly))).tolist()
    centre = (u * scale - 0.5, v * scale - 0.5)
    angle = min(fov, 360.0) / 2 if fov > 0 else None
    return f_theta_camera(file.at(POLYNOMIAL), size, centre, scaled, by_distance=True, max_angle_deg=angle)


def _pinhole(file: Section, size: tuple[int, int]) -> Camera:
    if OFFSET not in file:
        tell(f"{file.at(OFFSET)} is missing; taken to be [0, 0]")
    elif any(file.array(OFFSET, "two lengths", (2,))):
        raise file.fault(OFFSET, "[0, 0]")
    aperture = file.array("cameraAperture", "width and height", (2,))
    if not aperture[0] > 0:
        raise file.fault("cameraAperture", "a width above 0")
    focal = file.number("cameraFocalLength", "in the aperture's unit") / aperture[0] * size[0]
    params = {"fx": focal, "fy": focal, "cx": (size[0] - 1) / 2, "cy": (size[1] - 1) / 2}
    return camera_of(file.at("cameraFocalLength"), "pinhole", size, params)


def _pose(file: Section) -> FloatArray:
    """T_world_camera [4, 4], metres."""
    T = file.array(VIEW, "a 4x4 matrix for rows", (16,)).reshape(4, 4).T
    if not np.allclose(T[3], [0, 0, 0, 1], atol=1e-9):
        raise file.fault(VIEW, "a 4x4 matrix for rows, its last column 0 0 0 1")
    if UNIT not in file:
        tell(f"{file.at(UNIT)} is missing; taken to be 1, metres")
    metres = file.number(UNIT, "metres") if UNIT in file else 1.0
    if not metres > 0:
        raise file.fault(UNIT, "metres above 0")
    T = T.copy()
    with errors_at(file.at(VIEW)):
        T[:3, :3] = checked_rotation(T[:3, :3], "its 3x3 part")
    T[:3, 3] *= metres
    return inverse(Y_UP_Z_BACK @ T)


FORMAT = CameraFormat(
    "isaac",
    "Isaac Sim (Replicator) camera_params (JSON; two files)",
    lambda source: {VIEW, "cameraModel"} <= source.keys,
    read_posed,
)
