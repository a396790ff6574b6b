"""Kalibr's `camchain.yaml`: two cameras, and T_cn_cnm1 from one to the next.

The projections and their numbers are those of Kalibr's wiki, "Supported models" and "YAML formats".
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rectbench.cameras import Camera
from rectbench.errors import InvalidInput
from rectbench.rigs.documents import Section, blaming, parse_yaml, shown
from rectbench.rigs.rig import Rig

FOCAL = ("fx", "fy", "cx", "cy")


@dataclass(frozen=True)
class Layout:
    """A projection model and the order in which Kalibr lists its parameters."""

    model: str
    intrinsics: tuple[str, ...]
    distortion: tuple[str, ...] = ()


LAYOUTS = {
    ("pinhole", "none"): Layout("pinhole", FOCAL),
    ("pinhole", "radtan"): Layout("pinhole", FOCAL, ("k1", "k2", "p1", "p2")),
    ("pinhole", "equi"): Layout("kannala-brandt", FOCAL, ("k1", "k2", "k3", "k4")),
    ("pinhole", "equidistant"): Layout("kannala-brandt", FOCAL, ("k1", "k2", "k3", "k4")),
    ("pinhole", "fov"): Layout("field-of-view", FOCAL, ("omega",)),
    ("omni", "none"): Layout("unified", ("xi", *FOCAL)),
    ("omni", "radtan"): Layout("unified", ("xi", *FOCAL), ("k1", "k2", "p1", "p2")),
    ("ds", "none"): Layout("double-sphere", ("xi", "alpha", *FOCAL)),
    ("eucm", "none"): Layout("extended-unified", ("alpha", "beta", *FOCAL)),
}


def read_kalibr(path: str | os.PathLike[str], text: str, size: tuple[int, int] | None = None) -> Rig:
    """The rig of cam0 (left) and cam1 (right) in `text`, the content of the camchain `path`.

    Further cameras of the chain are left out. `size` stands in for a missing `resolution`. Raises
    InvalidInput in one line that names file, key and what was expected there.
    """
    chain = parse_yaml(text, str(path))
    left = chain.section("cam0", "the first camera, the left one")
    right = chain.section("cam1", "the second camera; a rig takes two")
    cameras = (_read_camera(left, size), _read_camera(right, size))
    T_right_left = right.matrix("T_cn_cnm1", "a 4x4 matrix [R t; 0 0 0 1] from cam0 to cam1, metres", 4, 4)
    if not np.array_equal(T_right_left[3], [0, 0, 0, 1]):
        raise InvalidInput(
            f"{right.at('T_cn_cnm1.3')} is {shown(T_right_left[3].tolist())}; expected [0, 0, 0, 1]"
        )
    with blaming(right.at("T_cn_cnm1")):
        return Rig(*cameras, T_right_left[:3, :3], T_right_left[:3, 3], name=Path(path).stem)


def _read_camera(section: Section, size: tuple[int, int] | None) -> Camera:
    projection = section.text("camera_model", "pinhole, omni, ds or eucm")
    known = [distortion for name, distortion in LAYOUTS if name == projection]
    if not known:
        raise section.fault("camera_model", "pinhole, omni, ds or eucm")
    distortion = section.values.get("distortion_model", "none")
    if distortion not in known:
        raise section.fault("distortion_model", f"{', '.join(known)} with {projection}")
    layout = LAYOUTS[projection, distortion]
    params = _read_parameters(section, "intrinsics", layout.intrinsics)
    if layout.distortion:
        params |= _read_parameters(section, "distortion_coeffs", layout.distortion)
    image = section.size("resolution", size)
    with blaming(section.at("").removesuffix(".")):
        return Camera(layout.model, image, params)


def _read_parameters(section: Section, key: str, names: tuple[str, ...]) -> dict[str, float]:
    numbers = section.numbers(key, f"{len(names)} finite numbers ({' '.join(names)})", len(names))
    return dict(zip(names, numbers, strict=True))
