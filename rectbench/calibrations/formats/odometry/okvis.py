"""OKVIS' and OKVIS2's configuration: a list `cameras`, each with its lens and `T_SC`.

`T_SC` takes points of the camera to the sensor that is the IMU, in metres. The distortions are OKVIS'
radialtangential (k1 k2 p1 p2), radialtangential8 (OpenCV's eight) and equidistant; pixel (0, 0) is the
centre of a pixel. Left and right are the first two, or those asked for: cam0, cam1, ... by their places.
"""

from __future__ import annotations

from collections.abc import Sequence

from rectbench.calibrations.assembling import camera_of, rig_of_list, single
from rectbench.calibrations.contract import Given, PosedCamera, RigFormat
from rectbench.calibrations.documents import Section, Source
from rectbench.calibrations.formats.toolboxes.opencv import ORDERS
from rectbench.rigs.rig import Rig

MODELS = {
    "radialtangential": ("pinhole", ORDERS["pinhole"][:4]),
    "radialtangential8": ("pinhole", ORDERS["pinhole"][:8]),
    "equidistant": ("kannala-brandt", ORDERS["fisheye"]),
}


def _read(sources: Sequence[Source], given: Given) -> Rig:
    source = single(sources)
    source.document.knows("camera_extrinsics")  # how sure these are
    return rig_of_list(source, source.document.section_of_list("cameras"), _read_posed, given)


def _read_posed(section: Section, given: Given) -> PosedCamera:
    model, order = MODELS[section.choice("distortion_type", MODELS)]
    params = section.named("focal_length", ("fx", "fy")) | section.named("principal_point", ("cx", "cy"))
    params |= section.named("distortion_coefficients", order)
    camera = camera_of(section.where, model, section.size("image_dimension", given.size), params)
    return PosedCamera(section.where, camera, section.rigid("T_SC", "the pose from camera to IMU, metres"))


def _recognises(source: Source) -> bool:
    cameras = source.document.values["cameras"] if "cameras" in source.keys else None
    return isinstance(cameras, list) and any(isinstance(item, dict) and "T_SC" in item for item in cameras)


FORMAT = RigFormat("okvis", "OKVIS and OKVIS2 configuration (YAML)", _recognises, _read, has_many=True)
