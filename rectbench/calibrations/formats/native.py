"""The project's own rig file, a YAML that people read and write.

    rectbench_rig: 1                # this format; marks the file as one
    name: my-rig                    # what reports call it; the file's stem if left out
    source: Calibrated with ...     # where the numbers come from and their licence; optional
    cameras:
      left:
        model: kannala-brandt       # a projection model, see `rectbench.cameras`
        size: [848, 800]            # image width and height, pixels
        params:                     # the model's parameters by name; what is left out is 0
          fx: 285.7                 # pixels; pixel (0, 0) is the centre of the top-left pixel
          ...
        max_angle_deg: 80.0         # angle from the axis where the image circle ends; optional
        blind:                      # what is left out of the view: two cones about a line; optional
          axis: [1.0, 0.0, 0.0]     # the line's direction in the camera's frame
          within_deg: 7.0           # the cones' half angle
      right: ...                    # likewise
    R_right_left:                   # X_right = R_right_left X_left + t_right_left
      - [1.0, 0.0, 0.0]
      - [0.0, 1.0, 0.0]
      - [0.0, 0.0, 1.0]
    t_right_left: [-0.064, 0.0, 0.0]    # metres, in the right camera's frame

Axes are x right, y down, z forward. A rig that is written and read again is the same to the last bit.
"""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path
from typing import Any

from rectbench.calibrations.assembling import assembled, camera_of, rigid, single
from rectbench.calibrations.contract import Given, RigFormat
from rectbench.calibrations.documents import Section, errors_at, parse_document
from rectbench.cameras import Camera, Cones
from rectbench.rigs.file_formats import Writing
from rectbench.rigs.rig import Rig
from rectbench.yaml_text import yaml_text

MARK = "rectbench_rig"
VERSION = "1"
LONGEST_MODEL = 40
"""Characters; a longer name is damage, which an error need not repeat."""


def read_native(path: str | os.PathLike[str], text: str) -> Rig:
    """The rig written in `text`, the content of the file `path`.

    Raises InvalidInput in one line that names file, key and what was expected there.
    """
    return read_fields(parse_document(text, str(path)), Given())


def read_fields(document: Section, given: Given) -> Rig:
    """The rig in that content."""
    document.only((MARK, "name", "source", "cameras", "R_right_left", "t_right_left"))
    if document.text(MARK, f"the format's version, {VERSION}") != VERSION:
        raise document.fault(MARK, f"the format's version, {VERSION}")
    name = document.text("name", "one printable line") if "name" in document else Path(document.file).stem
    source = document.text("source", "prose") if "source" in document else ""
    cameras = document.section("cameras", "the cameras left and right")
    cameras.only(("left", "right"))
    left, right = (_read_camera(cameras.section(side, "a camera"), given.size) for side in ("left", "right"))
    R = document.matrix("R_right_left", "a 3x3 rotation", 3, 3)
    t = document.numbers("t_right_left", "three metres", 3)
    rig = assembled(left, right, rigid(R, t), given, document.file, name, unit="m")
    return replace(rig, source=source)


def rig_fields(rig: Rig) -> dict[str, Any]:
    """The file's content as plain data."""
    content: dict[str, Any] = {MARK: int(VERSION), "name": rig.name}
    if rig.source:
        content["source"] = rig.source
    content["cameras"] = {"left": _camera_fields(rig.left), "right": _camera_fields(rig.right)}
    content["R_right_left"] = rig.R_right_left.tolist()
    content["t_right_left"] = rig.t_right_left.tolist()
    return content


def _read_camera(section: Section, size: tuple[int, int] | None) -> Camera:
    section.only(("model", "size", "params", "max_angle_deg", "blind"))
    model = section.text("model", "a projection model")
    if len(model) > LONGEST_MODEL:
        raise section.fault("model", "a projection model")
    params = section.section("params", "the model's parameters by name")
    values = {
        name: params.numbers(name, "finite numbers")
        if isinstance(value, list)
        else params.number(name, "a number")
        for name, value in params.values.items()
    }
    max_angle = section.number("max_angle_deg", "degrees") if "max_angle_deg" in section else None
    image = section.size("size", size)
    camera = camera_of(section.where, model, image, values, max_angle)
    return (
        replace(camera, blind=_read_cones(section.section("blind", "cones")))
        if "blind" in section
        else camera
    )


def _read_cones(section: Section) -> Cones:
    section.only(("axis", "within_deg"))
    x, y, z = section.numbers("axis", "a direction", 3)
    with errors_at(section.where):
        return Cones((x, y, z), section.number("within_deg", "degrees"))


def _camera_fields(camera: Camera) -> dict[str, Any]:
    params = {
        name: list(value) if isinstance(value, tuple) else value for name, value in camera.params.items()
    }
    fields: dict[str, Any] = {"model": camera.model, "size": list(camera.size), "params": params}
    if camera.max_angle_deg is not None:
        fields["max_angle_deg"] = float(camera.max_angle_deg)
    if camera.blind is not None:
        fields["blind"] = {"axis": list(camera.blind.axis), "within_deg": camera.blind.within_deg}
    return fields


FORMAT = RigFormat(
    "native",
    "rectbench's own YAML",
    lambda source: MARK in source.keys,
    lambda sources, given: read_fields(single(sources).document, given),
    write=Writing(lambda rig, name: {name: yaml_text(rig_fields(rig))}, losses=lambda rig: []),
)
