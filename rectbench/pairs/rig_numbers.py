"""A rig as plain numbers, for keys of the store."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from rectbench.cameras import Camera
from rectbench.rigs import Rig


def rig_numbers(rig: Rig) -> dict[str, Any]:
    """A rig as JSON: its name and every number in it."""
    return {
        "name": rig.name,
        "left": _camera_numbers(rig.left),
        "right": _camera_numbers(rig.right),
        "R_right_left": rig.R_right_left.tolist(),
        "t_right_left": rig.t_right_left.tolist(),
    }


def _camera_numbers(camera: Camera) -> dict[str, Any]:
    return {
        "model": camera.model,
        "size": list(camera.size),
        "params": {name: list(v) if isinstance(v, tuple) else v for name, v in camera.params.items()},
        "max_angle_deg": camera.max_angle_deg,
        **({} if camera.blind is None else {"blind": asdict(camera.blind)}),
    }
