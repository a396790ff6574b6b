"""Warps into the rectified frame, lookup tables, triangulation, and what a rectifier is."""

from rectbench.warps.description import load_rectification, save_rectification
from rectbench.warps.extent import ViewAngles, centre_rays, perspective_size, view_angles
from rectbench.warps.frame import centre_resolution_px, rectifying_rotations, refuse_epipole_in_view
from rectbench.warps.framing import Framing, framed
from rectbench.warps.opencv_form import OpenCVForm, opencv_form
from rectbench.warps.pinhole_view import HomographyRectifier, PinholeView
from rectbench.warps.profiles import Cubic, Profile, Radial
from rectbench.warps.rectification import Rectification
from rectbench.warps.rectifier import Images, Matches, Options, Problem, Rectifier, option, pose_problem
from rectbench.warps.resampling import Resampler
from rectbench.warps.sampling import evaluation_pixels, outline_pixels
from rectbench.warps.targets import Epipolar, Framed, Perspective, Target
from rectbench.warps.warp import Warp

__all__ = [
    "Cubic",
    "Epipolar",
    "Framed",
    "Framing",
    "HomographyRectifier",
    "Images",
    "Matches",
    "OpenCVForm",
    "Options",
    "Perspective",
    "PinholeView",
    "Problem",
    "Profile",
    "Radial",
    "Rectification",
    "Rectifier",
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
    "option",
    "outline_pixels",
    "perspective_size",
    "pose_problem",
    "rectifying_rotations",
    "refuse_epipole_in_view",
    "save_rectification",
    "view_angles",
]
