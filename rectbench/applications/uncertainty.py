"""What a calibration's uncertainty does to rows and depth, as files."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rectbench import metrics
from rectbench.applications.one_rig import calibrated_pair, estimate_rig_pose, rectify_rig, rig_of
from rectbench.applications.requests.photographs import PoseSettings, UncertaintyRequest
from rectbench.calibrations import load_covariance
from rectbench.errors import InvalidInput, argument
from rectbench.metrics import Uncertainty
from rectbench.pairs.finding.image_circle import ImageCircle
from rectbench.reporting.pictures.uncertainty_maps import map_pixels, write_uncertainty
from rectbench.rigs import Rig, RigCovariance
from rectbench.types import Images

POSE_SIZES = {"rotation_deg", "direction_deg"}


@dataclass(frozen=True, eq=False)
class PropagatedUncertainty:
    """What was found, from how sure a calibration, and the files that show it."""

    found: Uncertainty
    covariance: RigCovariance
    files: tuple[Path, ...]
    circle: ImageCircle | None = None
    """What the rig's lenses were held to, where a mask or the images themselves show it."""


def propagate_uncertainty(request: UncertaintyRequest) -> PropagatedUncertainty:
    """Write how far the calibration's uncertainty moves rows and depth: a picture, numbers and arrays.

    With two images and nothing stated about the pose, it is estimated from them with its own covariance, to
    which what is stated about lenses and baseline adds. Raises InvalidInput where nothing tells how sure
    the calibration is, and what `rectbench.rectify` raises; nothing is written then.
    """
    circle: ImageCircle | None = None
    images: Images | None = None
    if request.left is None:
        rig = rig_of(request)
    else:
        rig, images, circle = calibrated_pair(request)
    rig, covariance = _believed(rig, images, request)
    rect = rectify_rig(rig, request, images=images)
    found = metrics.uncertainty(
        rect,
        rig,
        covariance,
        depth_m=request.depth_m,
        matching_px=request.matching_px,
        pixels=map_pixels(rig.left),
    )
    facts = {"rig": rig.name, "method": request.method}
    files = write_uncertainty(found, covariance, rig.left, request.out, facts)
    return PropagatedUncertainty(found, covariance, tuple(files), circle)


def _believed(rig: Rig, images: Images | None, request: UncertaintyRequest) -> tuple[Rig, RigCovariance]:
    """The believed rig, whose pose images tell where nothing is stated about it, and its covariance."""
    sigmas: dict[str, Any] = request.sigmas
    parts = []
    if images is not None and not request.covariance and not POSE_SIZES & sigmas.keys():
        estimate = estimate_rig_pose(images, rig, PoseSettings(seed=request.seed))
        if estimate.note:
            raise InvalidInput(f"{estimate.note}; expected images of the calibrated rig")
        rig = estimate.rig(rig)
        parts.append(estimate.rig_covariance(rig))
    if request.covariance:
        parts.append(load_covariance(request.covariance, rig))
    if sigmas:
        words = ", ".join(f"{name} {sigma:g}" for name, sigma in sigmas.items())
        parts.append(RigCovariance.from_sigmas(rig, **sigmas, source=f"stated {words}"))
    if not parts:
        raise InvalidInput(
            f"nothing says how sure the calibration is; expected {argument('covariance')}, a size such as "
            f"{argument('rotation_deg', 0.05)}, or two images whose pose is estimated"
        )
    return rig, sum(parts[1:], start=parts[0])
