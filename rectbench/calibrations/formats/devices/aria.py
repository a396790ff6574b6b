"""Project Aria's calibration JSON: `CameraCalibrations`, each with a `Projection` and `T_Device_Camera`.

`Params` of FisheyeRadTanThinPrism are f cx cy k0 ... k5 p0 p1 s0 ... s3 (Fisheye624), those of Fisheye62 the
same without s0 ... s3, and those of KannalaBrandtK3 fx fy cx cy k0 ... k3. `T_Device_Camera` takes points of
the camera to the device: `Translation` in metres, `UnitQuaternion` [w, [x, y, z]] (projectaria_tools, camera
models and SensorCalibrationJson.cpp). Pixel (0, 0) is the centre of a pixel. The image size is that of
`ConfigData` or of `ImageSizes`, and else to be given: the cameras run at several sizes. Cameras go by
their labels; of more than two it is asked which are left and right, such as camera-slam-left and
camera-slam-right.
"""

from __future__ import annotations

from collections.abc import Sequence

from rectbench.calibrations.assembling import camera_of, rigid, single
from rectbench.calibrations.contract import Given, PosedCamera, RigFormat
from rectbench.calibrations.documents import Section, Source
from rectbench.calibrations.formats.named_cameras import (
    by_name,
    quaternion_rotation,
    rig_of_named,
)
from rectbench.errors import InvalidInput
from rectbench.rigs.rig import Rig
from rectbench.types import FloatArray

CAMERAS = "CameraCalibrations"
PAIR = ("camera-slam-left", "camera-slam-right")
FOCAL = ("fx", "fy", "cx", "cy")
FISHEYE624 = ("f", "cx", "cy", "k0", "k1", "k2", "k3", "k4", "k5", "p0", "p1", "s0", "s1", "s2", "s3")
MODELS = {
    "FisheyeRadTanThinPrism": ("fisheye624", FISHEYE624),
    "Fisheye62": ("fisheye624", FISHEYE624[:11]),
    "KannalaBrandtK3": ("kannala-brandt", (*FOCAL, "k1", "k2", "k3", "k4")),
}
CONFIG = ("ImageWidth", "ImageHeight")
SIZES = "ImageSizes"


def _read(sources: Sequence[Source], given: Given) -> Rig:
    source = single(sources)
    entries = source.document.section_of_list(CAMERAS)
    sections = [entries.section(place, "a camera") for place in entries.values]
    cameras = by_name((section.text("Label", "the camera's name"), section) for section in sections)

    def read(section: Section) -> PosedCamera:
        return _read_posed(section, _size(source.document, section, sections.index(section), given))

    return rig_of_named(source, cameras, read, given, "m", [PAIR])


def _read_posed(section: Section, size: tuple[int, int]) -> PosedCamera:
    if section.values.get("Calibrated", True) is not True:
        raise section.fault("Calibrated", "true")
    projection = section.section("Projection", "Name and Params")
    projection.only(("Name", "Params", "Description", "ProjectionModel"))
    projection.knows("Description", "ProjectionModel")  # of the names in words
    name = projection.choice("Name", MODELS)
    model, names = MODELS[name]
    params = projection.named("Params", names)
    if "f" in params:
        params["fx"] = params["fy"] = params.pop("f")
    camera = camera_of(section.where, model, size, params)
    return PosedCamera(section.where, camera, _pose(section.section("T_Device_Camera", "the camera's pose")))


def _size(file: Section, section: Section, place: int, given: Given) -> tuple[int, int]:
    if "ConfigData" in section:
        return section.section("ConfigData", "the image size").sides(*CONFIG, given.size)
    if SIZES in file:
        return file.section_of_list(SIZES).size(str(place), given.size)
    return section.sides(*CONFIG, given.size)


def _pose(pose: Section) -> FloatArray:
    """T_device_camera [4, 4], metres."""
    parts = pose.section_of_list("UnitQuaternion")
    if len(parts.values) != 2:
        raise InvalidInput(f"{pose.at('UnitQuaternion')} is no quaternion; expected [w, [x, y, z]]")
    wxyz = [parts.number("0", "w of a unit quaternion"), *parts.numbers("1", "x, y, z of it", 3)]
    R = quaternion_rotation(pose.at("UnitQuaternion"), wxyz)
    return rigid(R, pose.numbers("Translation", "three metres", 3))


FORMAT = RigFormat(
    "aria",
    "Project Aria device calibration (JSON)",
    lambda source: CAMERAS in source.keys,
    _read,
    has_many=True,
)
