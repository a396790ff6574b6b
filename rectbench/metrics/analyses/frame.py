"""What a frame costs: how fine the image is, what of the view it keeps, and what it does to pixels."""

from __future__ import annotations

from rectbench.margin import MARGIN_DEG
from rectbench.metrics.coverage import TRIMMED, coverage
from rectbench.metrics.log_distortion import log_distortion
from rectbench.metrics.sampling import sampling
from rectbench.rigs import Rig
from rectbench.scored import Delivered, ScoredView
from rectbench.warps import Rectification, centre_resolution_px
from rectbench.warps.view.framing import focal_px


def frame_costs(rect: Rectification, rig: Rig) -> dict[str, float]:
    """The numbers by which one frame of a rectified pair is held against another.

    - `width_px`, `height_px` of the rectified images; `focal_px` on the rectified frame's axis, and
      `magnification`, that against the source's at its centre.
    - `coverage_pixels`, `coverage_solid_angle`, `coverage_overlap`, `valid_output`, and
      `trimmed` where anything is, see `coverage`.
    - `sampling_lost`, `sampling_invented`, see `sampling`.
    - `log_distortion_kept`: log distortion over the pixels that stay in the frame.

    >>> import rectbench as rb
    >>> rig = rb.load_rig("t265")
    >>> costs = frame_costs(rb.rectify(rig, method="abraham"), rig)
    >>> 0 < costs["coverage_pixels"] <= 1
    True
    """
    focal = focal_px(rect)
    view = ScoredView.of(rig, margin_deg=rect.rig.margin_deg or MARGIN_DEG)
    shares, shown = coverage(rect, rig), Delivered.of(rect, view).shown
    return {
        "width_px": float(rect.size[0]),
        "height_px": float(rect.size[1]),
        "focal_px": focal,
        "magnification": focal / centre_resolution_px(rig),
        **{
            name: shares[name]
            for name in (
                "coverage_pixels",
                "coverage_solid_angle",
                "coverage_overlap",
                "valid_output",
                TRIMMED,
            )
            if name in shares
        },
        **sampling(shown),
        "log_distortion_kept": log_distortion(shown)["log_distortion"],
    }
