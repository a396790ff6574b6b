"""The verbs for an image pair of one's own: its pose, and its reconstruction."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rectbench.cli.app import (
    Cameras,
    LeftImage,
    MaxAngle,
    Method,
    MethodOptions,
    MethodSeed,
    RigFiles,
    RightImage,
    Unit,
    split_names,
)
from rectbench.plugins.defaults import DEFAULT_METHOD

if TYPE_CHECKING:
    from rectbench.rigs import Rig
    from rectbench.types import Images


def pose(
    left: LeftImage,
    right: RightImage,
    rig: RigFiles,
    out: Annotated[
        Path | None, typer.Option("--out", "-o", metavar="FILE", help="Write the rig in this pose as YAML.")
    ] = None,
    detector: Annotated[str, typer.Option(help="Of features: sift, akaze, orb or surf.")] = "sift",
    seed: Annotated[int, typer.Option(help="Of the random samples.")] = 0,
    max_angle_deg: MaxAngle = None,
    unit: Unit = None,
    cameras: Cameras = None,
) -> None:
    """Estimate from an image pair how the right camera stands to the left one.

    The calibration gives the two lenses and the length of the baseline; its own pose is compared with
    the estimate.
    """
    from rectbench import api
    from rectbench.cli import printing as terminal
    from rectbench.images.reading import read_images

    images = read_images(left, right)
    calibrated = _calibrated(rig, images, max_angle_deg, unit, cameras)
    estimate = api.estimate_pose(images, calibrated, detector=detector, seed=seed)
    terminal.show_pose(estimate, calibrated)
    if out is not None:
        estimate.rig(calibrated).save(out)
        print(out)


def reconstruct(
    left: LeftImage,
    right: RightImage,
    rig: RigFiles,
    out: Annotated[Path, typer.Option("--out", "-o", help="Folder for what is made.")] = Path(
        "reconstructed"
    ),
    method: Method = DEFAULT_METHOD,
    option: MethodOptions = None,
    seed: MethodSeed = 0,
    max_angle_deg: MaxAngle = None,
    unit: Unit = None,
    cameras: Cameras = None,
    matcher: Annotated[
        str, typer.Option(help="The dense matcher: sgbm, sgbm-5way, sgbm-8way or bm.")
    ] = "sgbm",
    nearest_baselines: Annotated[
        float, typer.Option(help="Nothing nearer is sought, in multiples of the baseline.")
    ] = 4.0,
    pixels: Annotated[
        float, typer.Option(help="A rectified image of more pixels is made smaller first.")
    ] = 1e6,
) -> None:
    """Reconstruct an image pair in 3-D: a coloured point cloud, depth, disparity and a picture."""
    from rectbench import api
    from rectbench.cli.configuring import read_method_options
    from rectbench.images.reading import read_images
    from rectbench.matching import reconstruct
    from rectbench.matching.dense.matchers import matcher_named
    from rectbench.reporting.pictures.reconstructed import write_reconstruction

    matcher_named(matcher)  # a wrong name is told before the work begins
    images = read_images(left, right)
    calibrated = _calibrated(rig, images, max_angle_deg, unit, cameras)
    rect = api.rectify(calibrated, method, images=images, seed=seed, **read_method_options(option))
    found = reconstruct(rect, *images, matcher, pixels=pixels, nearest_baselines=nearest_baselines)
    for file in write_reconstruction(found, out):
        print(file)


def _calibrated(
    rig: list[str], images: Images, max_angle_deg: float | None, unit: str | None, cameras: list[str] | None
) -> Rig:
    """The rig of calibration files, its lenses held to their image circle."""
    from rectbench.calibrations import load_rig_of_images

    size = images.left.shape[1::-1]
    calibrated = load_rig_of_images(rig, size, unit=unit, cameras=split_names(cameras))
    return calibrated if max_angle_deg is None else calibrated.within(max_angle_deg)
