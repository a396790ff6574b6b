"""rectbench: a bench for stereo rectification, fisheye first.

The names listed here are the public ones. They are imported when first used, so that
``import rectbench`` is quick and needs neither Mitsuba nor OpenCV.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rectbench import metrics as metrics
    from rectbench.api import rectify as rectify
    from rectbench.api import render as render
    from rectbench.api import run as run
    from rectbench.bench.report_spec import Report as Report
    from rectbench.cameras import Camera as Camera
    from rectbench.cameras import Projection as Projection
    from rectbench.errors import InvalidInput as InvalidInput
    from rectbench.errors import InvalidResult as InvalidResult
    from rectbench.errors import RectbenchError as RectbenchError
    from rectbench.errors import Unavailable as Unavailable
    from rectbench.errors import UnknownName as UnknownName
    from rectbench.errors import Unsupported as Unsupported
    from rectbench.matching import fundamental_matrix as fundamental_matrix
    from rectbench.matching import sampson_residuals as sampson_residuals
    from rectbench.matching import sift_matches as sift_matches
    from rectbench.rendering import blocks as blocks
    from rectbench.rendering.pair import StereoPair as StereoPair
    from rectbench.rendering.scene import scene as scene
    from rectbench.rendering.truth import Truth as Truth
    from rectbench.rendering.world import Instances as Instances
    from rectbench.rendering.world import Lamp as Lamp
    from rectbench.rendering.world import Material as Material
    from rectbench.rendering.world import Mesh as Mesh
    from rectbench.rendering.world import Sun as Sun
    from rectbench.rendering.world import World as World
    from rectbench.rigs import Rig as Rig
    from rectbench.rigs import load_rig as load_rig
    from rectbench.warps import Cubic as Cubic
    from rectbench.warps import Epipolar as Epipolar
    from rectbench.warps import Options as Options
    from rectbench.warps import Perspective as Perspective
    from rectbench.warps import Problem as Problem
    from rectbench.warps import Radial as Radial
    from rectbench.warps import Rectification as Rectification
    from rectbench.warps import Rectifier as Rectifier
    from rectbench.warps import Warp as Warp
    from rectbench.warps import option as option
    from rectbench.warps import view_angles as view_angles
    from rectbench.warps import refuse_epipole_in_view as refuse_epipole_in_view
    from rectbench.warps import rectifying_rotations as rectifying_rotations
    from rectbench.warps import perspective_size as perspective_size
    from rectbench.warps import outline_pixels as outline_pixels
    from rectbench.warps import evaluation_pixels as evaluation_pixels
    from rectbench.warps import centre_resolution_px as centre_resolution_px
    from rectbench.warps import centre_rays as centre_rays
    from rectbench.warps import ViewAngles as ViewAngles
    from rectbench.warps import PinholeView as PinholeView
    from rectbench.warps import Matches as Matches
    from rectbench.warps import HomographyRectifier as HomographyRectifier

_HOMES = {
    "metrics": "rectbench.metrics",
    "blocks": "rectbench.rendering.blocks",
    **dict.fromkeys(("rectify", "render", "run"), "rectbench.api"),
    "Report": "rectbench.bench.report_spec",
    **dict.fromkeys(("Camera", "Projection"), "rectbench.cameras"),
    **dict.fromkeys(
        ("InvalidInput", "InvalidResult", "RectbenchError", "Unavailable", "UnknownName", "Unsupported"),
        "rectbench.errors",
    ),
    **dict.fromkeys(("fundamental_matrix", "sampson_residuals", "sift_matches"), "rectbench.matching"),
    "StereoPair": "rectbench.rendering.pair",
    "scene": "rectbench.rendering.scene",
    "Truth": "rectbench.rendering.truth",
    **dict.fromkeys(("Instances", "Lamp", "Material", "Mesh", "Sun", "World"), "rectbench.rendering.world"),
    **dict.fromkeys(("Rig", "load_rig"), "rectbench.rigs"),
    **dict.fromkeys(
        (
            "Cubic",
            "Epipolar",
            "Options",
            "Perspective",
            "Problem",
            "Radial",
            "Rectification",
            "Rectifier",
            "Warp",
            "option",
            "view_angles",
            "refuse_epipole_in_view",
            "rectifying_rotations",
            "perspective_size",
            "outline_pixels",
            "evaluation_pixels",
            "centre_resolution_px",
            "centre_rays",
            "ViewAngles",
            "PinholeView",
            "Matches",
            "HomographyRectifier",
        ),
        "rectbench.warps",
    ),
}

__all__ = sorted(_HOMES)  # noqa: PLE0605
__version__ = "0.1.0"


def __getattr__(name: str) -> Any:
    home = _HOMES.get(name)
    if home is None:
        raise AttributeError(f"module 'rectbench' has no attribute '{name}'")
    module = import_module(home)
    value = module if home.endswith(f".{name}") and not hasattr(module, name) else getattr(module, name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
