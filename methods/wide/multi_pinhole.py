"""Several pinhole images side by side, as VINS-Fisheye and D2SLAM look at fisheye lenses for depth."""

import numpy as np

import rectbench as rb

from ._frames import in_epipolar_frame

WIDEST_DEG = 150.0
"""A wider piece is mostly stretched rim."""


class Options(rb.Options):
    pieces: int = rb.option(3, "how many images share the view about the baseline", ge=1, le=36)
    along_deg: float = rb.option(
        120.0, "the most that is shown along the baseline in the middle of a piece", gt=0, lt=180
    )
    focal_px: float | None = rb.option(
        None, "f of the pieces in px; the sources' centre resolution where left out", gt=0
    )


class MultiPinhole(rb.Rectifier[Options]):
    """û = f x / z_k, v̂ = f y_k / z_k in piece k: pinholes whose planes stand around the baseline as a prism.

    In each the rows are epipolar planes, the same in both images; one below the other they make one image,
    with a kink in û where two meet. VINS-Fisheye has pieces of 90° about the baseline of an upper and a lower
    camera, D2SLAM two of each lens, 90° apart. Nothing is shown near the ends of the baseline.
    """

    name = "multi-pinhole"
    references = (
        "Gao, Wang, Ding, Gao, Qin and Shen, Autonomous aerial robot using dual-fisheye cameras, "
        "Journal of Field Robotics 37(4), 2020",
        "Xu, Liu, Chen and Shen, D2SLAM: decentralized and distributed collaborative visual-inertial SLAM "
        "system for aerial swarm, IEEE Transactions on Robotics 40, 2024",
    )

    def fit(self, problem: rb.Problem, options: Options) -> rb.Rectification:
        rig, beta = problem.rig, rb.view_angles(problem.rig).beta
        focal = options.focal_px or rb.centre_resolution_px(rig)
        piece = (beta.high - beta.low) / options.pieces
        if not piece < np.radians(WIDEST_DEG):
            raise rb.Unsupported(
                f"pieces={options.pieces} would each be {np.degrees(piece):.0f}° wide about the baseline; "
                f"expected enough of them to stay below {WIDEST_DEG:.0f}°"
            )
        prism = rb.Prism(focal, 0.0, 0.0, beta.low + piece / 2, piece, options.pieces)
        notes: dict[str, float | str] = {"focal_px": focal, "piece_deg": float(np.degrees(piece))}
        reach_px = focal * float(np.tan(np.radians(options.along_deg) / 2))
        return in_epipolar_frame(rig, prism, notes, (reach_px, np.inf))
