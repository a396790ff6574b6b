"""The verb that says what a calibration's uncertainty does to rows and depth."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from rectbench.cli.app import (
    Cameras,
    MaxAngle,
    Method,
    MethodOptions,
    MethodSeed,
    RigFiles,
    Unit,
    split_names,
)
from rectbench.errors import InvalidInput
from rectbench.plugins.defaults import DEFAULT_METHOD

POSE_SIZES = {"rotation_deg", "direction_deg"}

if TYPE_CHECKING:
    from rectbench.rigs import Rig, RigCovariance
    from rectbench.types import Images


def uncertainty(
    rig: RigFiles,
    left: Annotated[Path | None, typer.Argument(metavar="LEFT", help="The left image.")] = None,
    right: Annotated[Path | None, typer.Argument(metavar="RIGHT", help="The right image.")] = None,
    covariance: Annotated[
        list[str] | None,
        typer.Option(
            metavar="FILE",
            help="How sure the calibration is: YAML with sigmas or a covariance, Kalibr's results-cam.txt, "
            "or OpenCV's standard deviations, a file a camera, left first.",
        ),
    ] = None,
    rotation_deg: Annotated[
        float | None, typer.Option(min=0, help="σ of the right camera's rotation, its size over all axes.")
    ] = None,
    direction_deg: Annotated[
        float | None, typer.Option(min=0, help="σ of the baseline's direction in the left camera's frame.")
    ] = None,
    baseline_mm: Annotated[float | None, typer.Option(min=0, help="σ of the baseline's length.")] = None,
    focal_px: Annotated[
        float | None, typer.Option(min=0, help="σ of each camera's fx; fy moves along.")
    ] = None,
    centre_px: Annotated[float | None, typer.Option(min=0, help="σ of each camera's cx and cy.")] = None,
    out: Annotated[Path, typer.Option("--out", "-o", help="Folder for what is made.")] = Path("uncertainty"),
    method: Method = DEFAULT_METHOD,
    option: MethodOptions = None,
    depth_m: Annotated[
        list[str] | None,
        typer.Option(
            metavar="METRES",
            help="Distances of the points seen, such as 1,10,inf; else 10 and 100 baselines and infinity.",
        ),
    ] = None,
    matching_px: Annotated[
        float, typer.Option(min=0, help="σ of a match's disparity, in rectified pixels.")
    ] = 0.25,
    seed: MethodSeed = 0,
    max_angle_deg: MaxAngle = None,
    unit: Unit = None,
    cameras: Cameras = None,
) -> None:
    """Tell how far the calibration's uncertainty moves rows and depth: a picture, numbers and arrays.

    With two images and nothing said about the pose, it is estimated from them with its own covariance, to
    which what is said about lenses and baseline adds.
    """
    from rectbench import api, metrics
    from rectbench.calibrations import load_rig
    from rectbench.cli import printing as terminal
    from rectbench.cli.configuring import read_method_options
    from rectbench.images.reading import read_images
    from rectbench.reporting.pictures.uncertainty_maps import map_pixels, write_uncertainty

    if (left is None) != (right is None):
        raise InvalidInput(f"one image was given, {left}; expected LEFT and RIGHT, or none")
    depths = _distances(depth_m)
    images = None if left is None or right is None else read_images(left, right)
    size = None if images is None else images.left.shape[1::-1]
    believed = load_rig(rig, size=size, unit=unit, cameras=split_names(cameras))
    if max_angle_deg is not None:
        believed = believed.within(max_angle_deg)
    sizes = {
        "rotation_deg": rotation_deg,
        "direction_deg": direction_deg,
        "baseline_m": None if baseline_mm is None else baseline_mm / 1000,
        "focal_px": focal_px,
        "centre_px": centre_px,
    }
    stated = {name: sigma for name, sigma in sizes.items() if sigma is not None}
    believed, how_sure = _how_sure(believed, images, covariance or [], stated, seed)
    rect = api.rectify(believed, method, images=images, seed=seed, **read_method_options(option))
    grid = map_pixels(believed.left)
    found = metrics.uncertainty(
        rect, believed, how_sure, depth_m=depths, matching_px=matching_px, pixels=grid
    )
    files = write_uncertainty(found, how_sure, believed.left, out, {"rig": believed.name, "method": method})
    terminal.show_uncertainty(found, how_sure)
    for file in files:
        print(file)


def _how_sure(
    rig: Rig, images: Images | None, files: list[str], stated: dict[str, Any], seed: int
) -> tuple[Rig, RigCovariance]:
    """The believed rig, whose pose images tell where nothing is said of it, and its covariance."""
    from rectbench import api
    from rectbench.calibrations import load_covariance
    from rectbench.rigs import RigCovariance

    parts = []
    if images is not None and not files and not POSE_SIZES & stated.keys():
        estimate = api.estimate_pose(images, rig, seed=seed)
        if estimate.note:
            raise InvalidInput(f"{estimate.note}; expected images of the calibrated rig")
        rig = estimate.rig(rig)
        parts.append(estimate.rig_covariance(rig))
    if files:
        parts.append(load_covariance(files, rig))
    if stated:
        words = ", ".join(f"{name} {sigma:g}" for name, sigma in stated.items())
        parts.append(RigCovariance.from_sigmas(rig, **stated, source=f"stated {words}"))
    if not parts:
        raise InvalidInput(
            "nothing says how sure the calibration is; expected --covariance FILE, a size such as "
            "--rotation-deg 0.05, or two images whose pose is estimated"
        )
    return rig, sum(parts[1:], start=parts[0])


def _distances(texts: list[str] | None) -> list[float] | None:
    words = split_names(texts)
    try:
        return None if words is None else [float(word) for word in words]
    except ValueError:
        raise InvalidInput(
            f"--depth-m is {','.join(words or [])}; expected distances in metres such as 1,10,inf"
        ) from None
