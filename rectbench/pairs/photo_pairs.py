"""Photographs as the pair under a cell: read from their own files, with the calibration as it is."""

from __future__ import annotations

from pathlib import Path

from rectbench.images.reading import read_images, rgb8
from rectbench.images.stereo_pair import StereoPair
from rectbench.pairs.finding.found_calibrations import Calibration
from rectbench.pairs.rig_numbers import rig_numbers
from rectbench.pairs.spec import PhotographedSpec
from rectbench.rigs import Rig
from rectbench.store.keys import Inputs, code_digest, file_digest, versions

READING_PACKAGES = ("numpy", "scipy", "opencv-contrib-python-headless")


def calibrated_rig(pair: PhotographedSpec) -> Rig:
    """The rig as its calibration files state it."""
    files = tuple(map(Path, pair.calibration))
    return Calibration(
        pair.rig,
        files,
        files[0].parent,
        pair.size,
        pair.unit,
        max_angle_deg=pair.max_angle_deg,
        cameras=pair.cameras,
    ).rig()


def calibration_inputs(pair: PhotographedSpec) -> Inputs:
    """All that shapes the calibrated rig, and what random numbers of the pair are named after."""
    return {
        "photographs_of": pair.scene,
        "rig": rig_numbers(calibrated_rig(pair)),
        "seed": pair.seed,
        "code": code_digest(__name__),
        "versions": dict(versions(*READING_PACKAGES)),
    }


def photo_inputs(pair: PhotographedSpec) -> Inputs:
    """All that shapes the images, the bytes of their files among it: an edited image is another one."""
    return {**calibration_inputs(pair), "images": [_digest(pair.left), _digest(pair.right)]}


def read_photographs(pair: PhotographedSpec) -> StereoPair:
    """The two images, 8 bits of RGB each; InvalidInput for what is no image, or not of its camera's size."""
    images = read_images(pair.left, pair.right)
    photographs = StereoPair(rgb8(images.left, "left"), rgb8(images.right, "right"))
    photographs.check(calibrated_rig(pair))
    return photographs


def _digest(image: str) -> str | None:
    """Of the file's bytes; None where it is gone, which a cell of its own then says."""
    try:
        return file_digest(Path(image))
    except OSError:
        return None
