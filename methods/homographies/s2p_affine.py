"""Affine rectification of narrow views (de Franchis, Meinhardt-Llopis, Michel, Morel and Facciolo 2014)."""

import numpy as np

import rectbench as rb

from ._homographies import closest_columns, refuse_apart, rows_rms_px


class S2PAffine(rb.HomographyRectifier):
    """Two similarities from the affine fundamental matrix of least error, then a shear of the right columns.

    Serves views in which perspective is as good as parallel: narrow ones of things farther away than deep,
    such as tiles of satellite images. `rows_rms_px` is what it leaves between the rows of the matches.
    """

    name = "s2p-affine"
    references = (
        "de Franchis, Meinhardt-Llopis, Michel, Morel and Facciolo, On Stereo-Rectification of Pushbroom "
        "Images, ICIP 2014",
        "Hartley and Zisserman, Multiple View Geometry in Computer Vision, 2004, algorithm 14.1",
    )

    def homographies(
        self, view: rb.PinholeView, options: rb.Options
    ) -> tuple[np.ndarray, np.ndarray, dict[str, float | str]]:
        left, right = view.matches
        S_left, S_right = similarities(left, right)
        rms_px = rows_rms_px(S_left, left, S_right, right)
        refuse_apart(
            rms_px, view, "affine maps leave", "a view so narrow that perspective is as good as parallel"
        )
        H_right = closest_columns(S_right, right, S_left, left) @ S_right
        return S_left, H_right, {"rows_rms_px": rms_px}


def similarities(left: np.ndarray, right: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The similarities [3, 3] of both images after which rows correspond, sharing the change of scale.

    a x' + b y' + c x + d y + e = 0 is the plane nearest to the matches (x, y), (x', y') in four dimensions.
    """
    points = np.column_stack([right, left])
    middle = points.mean(axis=0)
    normal = np.linalg.svd(points - middle, full_matrices=False)[2][-1]
    a, b, c, d = normal if normal[3] - normal[1] >= 0 else -normal  # of the two signs the upright one
    e = -np.array([a, b, c, d]) @ middle
    r, s = np.hypot(c, d), np.hypot(a, b)
    zoom, half = np.sqrt(r / s), e / (2 * np.sqrt(r * s))
    S_left = np.array([[zoom * d / r, -zoom * c / r, 0], [zoom * c / r, zoom * d / r, half], [0, 0, 1]])
    S_right = np.array([[-b, a, 0], [-a, -b, -half * s * zoom], [0, 0, s * zoom]]) / (s * zoom)
    return S_left, S_right
