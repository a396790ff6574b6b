"""The verbs for photographs and calibrations of one's own."""

from __future__ import annotations

from rectbench.applications.requests.photographs import (
    ConvertRequest,
    PoseRequest,
    ReconstructRequest,
    RectifyRequest,
    UncertaintyRequest,
)
from rectbench.cli.app import GOOD, INCOMPLETE, verb


@verb(RectifyRequest)
def rectify(request: RectifyRequest) -> int:
    """Rectify image pairs: images, masks, lookup tables, the rig's description, and what the frame costs.

    LEFT and RIGHT are two images, two folders, or two patterns such as 'left/*.png' in quotation marks.
    Without them all but the images is written for --rig: tables, masks, description, a preview of a grid.
    Exit code 3 where some of several pairs had to be left out.
    """
    from rectbench.applications.photographs.rectify import rectify_photographs
    from rectbench.cli.printing.photographs import show_rectified

    made = rectify_photographs(request)
    show_rectified(made)
    return INCOMPLETE if made.left_out else GOOD


@verb(PoseRequest)
def pose(request: PoseRequest) -> int:
    """Estimate from an image pair how the right camera stands to the left one.

    The calibration gives the two lenses and the length of the baseline; its own pose is compared with
    the estimate.
    """
    from rectbench.applications.one_rig import calibrated_pair, estimate_rig_pose
    from rectbench.cli.printing.photographs import show_circle, show_pose

    rig, images, circle = calibrated_pair(request)
    estimate = estimate_rig_pose(images, rig, request)
    show_circle(circle)
    show_pose(estimate, rig)
    if request.out is not None:
        estimate.rig(rig).save(request.out)
        print(request.out)
    return GOOD


@verb(ReconstructRequest)
def reconstruct(request: ReconstructRequest) -> int:
    """Reconstruct an image pair in 3-D: a coloured point cloud, depth, disparity and a picture."""
    from rectbench.applications.one_rig import calibrated_pair, rectify_rig
    from rectbench.cli.printing.photographs import show_circle
    from rectbench.matching import matcher_named, reconstruct
    from rectbench.reporting.pictures.reconstructed import write_reconstruction

    matcher_named(request.matcher)  # a wrong name is told before the work begins
    rig, images, circle = calibrated_pair(request)
    rect, how = rectify_rig(rig, request, images=images), {"nearest_baselines", "pixels"}
    found = reconstruct(rect, *images, request.matcher, **request.model_dump(include=how))
    show_circle(circle)
    for file in write_reconstruction(found, request.out):
        print(file)
    return GOOD


@verb(UncertaintyRequest)
def uncertainty(request: UncertaintyRequest) -> int:
    """Tell how far the calibration's uncertainty moves rows and depth: a picture, numbers and arrays.

    With two images and nothing said about the pose, it is estimated from them with its own covariance, to
    which what is said about lenses and baseline adds.
    """
    from rectbench.applications.uncertainty import propagate_uncertainty
    from rectbench.cli.printing.photographs import show_circle, show_uncertainty

    propagated = propagate_uncertainty(request)
    show_circle(propagated.circle)
    show_uncertainty(propagated.found, propagated.covariance)
    for file in propagated.files:
        print(file)
    return GOOD


@verb(ConvertRequest)
def convert(request: ConvertRequest) -> int:
    """Write a calibration in another format, exactly, or tell why that format cannot hold it."""
    from rectbench.applications.one_rig import rig_of

    for file in rig_of(request).save(request.out, request.to):
        print(file)
    return GOOD
