"""Two calibrated cameras, their pose and its uncertainty, and saving them. Imports cameras and below."""

from rectbench.rigs.covariance import RigCovariance as RigCovariance
from rectbench.rigs.motions import MOTIONS as MOTIONS
from rectbench.rigs.motions import Motion as Motion
from rectbench.rigs.poses import POSES as POSES
from rectbench.rigs.poses import PoseNoise as PoseNoise
from rectbench.rigs.poses import perturb as perturb
from rectbench.rigs.rig import Rig as Rig
from rectbench.rigs.saving import written_formats as written_formats
