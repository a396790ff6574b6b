"""The calibration files people have: read, recognised, assembled to rigs. Imports rigs and what is below."""

from rectbench.calibrations.built_in_rigs import fisheye_rigs as fisheye_rigs
from rectbench.calibrations.built_in_rigs import rig_names as rig_names
from rectbench.calibrations.choosing import CamerasNotChosen as CamerasNotChosen
from rectbench.calibrations.covariance_files import load_covariance as load_covariance
from rectbench.calibrations.documents.telling import telling as telling
from rectbench.calibrations.documents.telling import told_already as told_already
from rectbench.calibrations.reading import load_rig as load_rig
from rectbench.calibrations.reading import load_rig_of_images as load_rig_of_images
from rectbench.calibrations.recognising import calibration_formats as calibration_formats
from rectbench.calibrations.recognising import holds_many as holds_many
from rectbench.calibrations.recognising import is_calibration as is_calibration
