"""Warps into the rectified frame, their lookup tables, frames and files. Imports calibrations and below."""

from rectbench.warps.description import load_rectification as load_rectification
from rectbench.warps.description import save_rectification as save_rectification
from rectbench.warps.frame import centre_resolution_px as centre_resolution_px
from rectbench.warps.frame import rectifying_rotations as rectifying_rotations
from rectbench.warps.frame import refuse_epipole_in_view as refuse_epipole_in_view
from rectbench.warps.lookup.resampling import Resampler as Resampler
from rectbench.warps.opencv_form import OpenCVForm as OpenCVForm
from rectbench.warps.opencv_form import opencv_form as opencv_form
from rectbench.warps.profiles import Cubic as Cubic
from rectbench.warps.profiles import Profile as Profile
from rectbench.warps.profiles import Radial as Radial
from rectbench.warps.rectification import Rectification as Rectification
from rectbench.warps.targets import Epipolar as Epipolar
from rectbench.warps.targets import Framed as Framed
from rectbench.warps.targets import Perspective as Perspective
from rectbench.warps.targets import Target as Target
from rectbench.warps.view.extent import ViewAngles as ViewAngles
from rectbench.warps.view.extent import centre_rays as centre_rays
from rectbench.warps.view.extent import perspective_size as perspective_size
from rectbench.warps.view.extent import view_angles as view_angles
from rectbench.warps.view.framing import Framing as Framing
from rectbench.warps.view.framing import framed as framed
from rectbench.warps.view.sampling import evaluation_pixels as evaluation_pixels
from rectbench.warps.view.sampling import outline_pixels as outline_pixels
from rectbench.warps.warp import Warp as Warp
