"""Warps into the rectified frame, their lookup tables, frames and files. Imports calibrations and below."""

from rectbench.warps.description import load_rectification, save_rectification
from rectbench.warps.frame import centre_resolution_px, rectifying_rotations, refuse_epipole_in_view
from rectbench.warps.lookup.resampling import Resampler
from rectbench.warps.opencv_form import OpenCVForm, opencv_form
from rectbench.warps.profiles import Cubic, Profile, Radial
from rectbench.warps.rectification import Rectification
from rectbench.warps.targets import Epipolar, Framed, Perspective, Target
from rectbench.warps.view.extent import ViewAngles, centre_rays, perspective_size, view_angles
from rectbench.warps.view.framing import Framing, framed
from rectbench.warps.view.sampling import evaluation_pixels, outline_pixels
from rectbench.warps.warp import Warp

__all__ = [
    "Cubic",
    "Epipolar",
    "Framed",
    "Framing",
    "OpenCVForm",
    "Perspective",
    "Profile",
    "Radial",
    "Rectification",
    "Resampler",
    "Target",
    "ViewAngles",
    "Warp",
    "centre_rays",
    "centre_resolution_px",
    "evaluation_pixels",
    "framed",
    "load_rectification",
    "opencv_form",
    "outline_pixels",
    "perspective_size",
    "rectifying_rotations",
    "refuse_epipole_in_view",
    "save_rectification",
    "view_angles",
]
