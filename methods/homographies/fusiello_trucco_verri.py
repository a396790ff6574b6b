"""Rectification of a calibrated pair in a few lines (Fusiello, Trucco and Verri 2000)."""

import numpy as np

import rectbench as rb


class FusielloTruccoVerri(rb.HomographyRectifier):
    """K R_i K⁻¹: rows along the baseline and across the left camera's axis; the right camera has no say.

    K, free in the paper, is that of the undistorted views.
    """

    name = "fusiello-trucco-verri"
    references = (
        "Fusiello, Trucco and Verri, A Compact Algorithm for Rectification of Stereo Pairs, "
        "Machine Vision and Applications 12(1), 2000",
    )
    needs = frozenset({"pose"})

    def homographies(
        self, view: rb.PinholeView, options: rb.Options
    ) -> tuple[np.ndarray, np.ndarray, dict[str, float | str]]:
        rig, K, K_inverse = view.rig, view.K, np.linalg.inv(view.K)
        # The paper has the left camera on the left; the other way round images would stand on their heads.
        x = rig.centre_right_in_left * (-1 if rig.is_right_first else 1)
        y = np.cross([0, 0, 1], x)
        z = np.cross(x, y)
        R_rect_left = np.stack([axis / np.linalg.norm(axis) for axis in (x, y, z)])
        R_rect_right = R_rect_left @ rig.R_right_left.T
        return K @ R_rect_left @ K_inverse, K @ R_rect_right @ K_inverse, {}
