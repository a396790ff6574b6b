"""Agisoft Metashape's camera XML, as "Export Cameras" writes it: `sensors`, `cameras`, the chunk's scale.

A camera's `transform` takes its points to the chunk, or to the component it is in, whose `scale` makes them
metres; where there is none, the scale is arbitrary, which is told. Its axes are x right, y down, z forward.
The pixel is u = w/2 + cx + x' (f + b1) + y' b2, v = h/2 + cy + y' f, and (0.5, 0.5) is the centre of the
top-left pixel (Metashape's manual, appendix "Camera models"). x', y' are moved by k1 ... k4 and by p1, p2,
which are the p2, p1 of OpenCV.

| sensor | here |
|---|---|
| frame with k1 k2 k3 p1 p2 | pinhole; with b2 or k4, radial-tangential |
| fisheye (equidistant), the same terms of the point at the radius θ | thin-prism-fisheye |
| fisheye without p1, p2 | kannala-brandt, where b2 is its skew |
| equisolid_fisheye without terms | equisolid |

p3 and p4 have no place here. Of a multi-camera system only cameras with a transform of their own are read.
The cameras are those that are aligned, and go by their labels.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any
from xml.etree.ElementTree import Element

from rectbench.calibrations.assembling import camera_of, single
from rectbench.calibrations.contract import Given, PosedCamera, RigFormat
from rectbench.calibrations.documents import Section, Source, agreed_size, one_line, shown
from rectbench.calibrations.documents.elements import parse_elements
from rectbench.calibrations.documents.parsing import Malformed
from rectbench.calibrations.formats.named_cameras import by_name, rig_of_named, told_scale
from rectbench.cameras import Camera
from rectbench.errors import InvalidInput, argument
from rectbench.rigs.rig import Rig

PARAMETERS = ("f", "cx", "cy", "b1", "b2", "k1", "k2", "k3", "k4", "p1", "p2", "p3", "p4")
FISHEYES = ("fisheye", "equidistant_fisheye")
TYPES = ("frame", *FISHEYES, "equisolid_fisheye")


@dataclass(frozen=True)
class _Chunk:
    """What the elements of a file say of its cameras, before any number is looked at."""

    file: str
    sensors: dict[str, Element]
    cameras: dict[str, Element]
    slaves: tuple[str, ...]
    scales: dict[str, str | None]
    scale: str | None

    def scale_of(self, camera: Element) -> str | None:
        """The scale of the camera's component, or else of the chunk, as text."""
        return self.scales.get(camera.get("component_id", ""), self.scale)


def _read(sources: Sequence[Source], given: Given) -> Rig:
    source = single(sources)
    chunk = _chunk(source)
    of_rig: list[Element] = []

    def read(camera: Element) -> PosedCamera:
        of_rig.append(camera)
        return _read_posed(chunk, camera, given)

    _check_slaves(chunk, given)
    scales = {chunk.scale_of(camera) for camera in chunk.cameras.values()}
    unit = told_scale(source.path, given) if scales == {None} else "m"
    rig = rig_of_named(source, chunk.cameras, read, given, unit)
    components = {camera.get("component_id") for camera in of_rig}
    if len(components) > 1:
        raise InvalidInput(f"{source.path}: the cameras are of different components; expected one of both")
    return rig


def _check_slaves(chunk: _Chunk, given: Given) -> None:
    """Raise where a camera without a transform of its own is asked for, or may be meant."""
    for name in chunk.slaves:
        if given.cameras is None or name in given.cameras:
            raise InvalidInput(
                f"{chunk.file}: camera {shown(name)} is a slave of a multi-camera system and has no "
                f"transform of its own; expected `{argument('cameras')}` two that have one"
            )


def _chunk(source: Source) -> _Chunk:
    try:
        root = parse_elements(source.text)
    except Malformed as error:
        raise InvalidInput(f"{source.path}: {one_line(error)}; expected Metashape's camera XML") from None
    chunks = [root] if root.tag == "chunk" else root.findall("chunk")
    if len(chunks) != 1:
        raise InvalidInput(f"{source.path}: holds {len(chunks)} chunks; expected the cameras of one")
    chunk = chunks[0]
    cameras = list(chunk.iter("camera"))
    aligned = (camera for camera in cameras if camera.find("transform") is not None)
    slaves = (camera for camera in cameras if camera.find("transform") is None and _has_master(camera))
    components = {part.get("id", ""): _scale(part) for part in chunk.findall("components/component")}
    return _Chunk(
        source.path,
        {sensor.get("id", ""): sensor for sensor in chunk.findall("sensors/sensor")},
        by_name((camera.get("label", camera.get("id", "")), camera) for camera in aligned),
        tuple(camera.get("label", camera.get("id", "")) for camera in slaves),
        components,
        _scale(chunk),
    )


def _has_master(camera: Element) -> bool:
    return camera.get("master_id", camera.get("id")) != camera.get("id")


def _scale(element: Element) -> str | None:
    scale = element.find("transform/scale")
    return None if scale is None else scale.text


def _read_posed(chunk: _Chunk, camera: Element, given: Given) -> PosedCamera:
    label = one_line(camera.get("label", camera.get("id", "")))
    element = camera.find("transform")
    words = [] if element is None else (element.text or "").split()
    key = f"camera {shown(label)}."
    section = Section(chunk.file, key, {"transform": words, "scale": chunk.scale_of(camera) or "1"})
    T = section.rigid("transform", "the camera's pose in the chunk").copy()
    scale = section.number("scale", "the chunk's scale")
    if not scale > 0:
        raise section.fault("scale", "a number above 0")
    T[:3, 3] *= scale
    sensor = chunk.sensors.get(camera.get("sensor_id", ""))
    if sensor is None:
        raise InvalidInput(f"{section.at('sensor_id')} is no sensor of the file; expected one of them")
    return PosedCamera(section.where, _camera(chunk.file, sensor, given), T)


def _camera(file: str, sensor: Element, given: Given) -> Camera:
    key = f"sensor {shown(sensor.get('label', sensor.get('id', '')))}."
    found = sensor.findall("calibration")
    adjusted = [calibration for calibration in found if calibration.get("class") == "adjusted"] or found
    if len(adjusted) != 1:
        raise InvalidInput(f"{file}: {key}calibration: there are {len(found)}; expected one that is adjusted")
    (calibration,) = adjusted
    values: dict[str, Any] = {child.tag: (child.text or "").strip() for child in calibration}
    values["type"] = calibration.get("type", sensor.get("type", ""))
    section = Section(file, f"{key}calibration.", values)
    section.only((*PARAMETERS, "type", "resolution", "date"))
    kind = section.choice("type", TYPES)
    if kind != sensor.get("type", kind):
        raise section.fault("type", f"{shown(sensor.get('type'))}, as the sensor's own")
    size = _size(section, sensor, calibration, given)
    n = {name: section.number(name, "a number") if name in section else 0.0 for name in PARAMETERS}
    params = {
        "fx": n["f"] + n["b1"],
        "fy": n["f"],
        "cx": size[0] / 2 + n["cx"] - 0.5,
        "cy": size[1] / 2 + n["cy"] - 0.5,
    }
    model, distortion = _lens(section, kind, n)
    return camera_of(section.where, model, size, params | distortion)


def _size(section: Section, sensor: Element, calibration: Element, given: Given) -> tuple[int, int]:
    for element in (calibration.find("resolution"), sensor.find("resolution")):
        if element is not None:
            sides = (element.get("width"), element.get("height"))
            return agreed_size(section.at("resolution"), sides, given.size)
    return section.sides("resolution", "", given.size)


def _lens(section: Section, kind: str, n: dict[str, float]) -> tuple[str, dict[str, float]]:
    """The projection model, and the parameters of it that are not the focal length and centre."""
    radial = {name: n[name] for name in ("k1", "k2", "k3", "k4")}
    tangential = {"p1": n["p2"], "p2": n["p1"]}
    skewed = n["b2"] != 0
    is_plain = n["p1"] == n["p2"] == 0
    if n["p3"] or n["p4"]:
        name = "p3" if n["p3"] else "p4"
        raise section.fault(name, "0, as rectbench has no such term")
    if kind == "equisolid_fisheye" and is_plain and not skewed and not any(radial.values()):
        return "equisolid", {}
    if kind in FISHEYES and is_plain:
        return "kannala-brandt", radial | {"skew": n["b2"]}
    if kind in FISHEYES and not skewed:
        return "thin-prism-fisheye", radial | tangential
    if kind == "frame" and (skewed or n["k4"]):
        return "radial-tangential", radial | tangential | {"skew": n["b2"]}
    if kind == "frame":
        del radial["k4"]
        return "pinhole", radial | tangential
    given = ", ".join(f"{name} = {n[name]:g}" for name in ("b2", *radial, "k4", "p1", "p2") if n[name])
    raise InvalidInput(f"{section.where} is a {kind} with {given}, no lens here; expected fewer terms")


def _recognises(source: Source) -> bool:
    return "<sensors" in source.head and "<document" in source.head[:200]


FORMAT = RigFormat("metashape", "Agisoft Metashape cameras (XML)", _recognises, _read, has_many=True)
