"""What homographies that rectify have in common, after Loop and Zhang (1999).

Two homographies make rows correspond where their rows v and w are corresponding epipolar lines:
v̂ = (v · x)/(w · x) is then the same number for a pixel x and its match. The first row u of each is free.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial import Polynomial

import rectbench as rb

WORST_ROWS_SHARE = 0.005
"""Of the image's height: matches whose rows are farther apart are not rectified."""


@dataclass(frozen=True, eq=False)
class Pencils:
    """The epipolar lines of both images in pairs, w_0 + t v.

    v goes through the middle of the left image, w_0 is the line there farthest from it. (Loop and Zhang name
    a pair by a pixel at infinity of its left line, which tells none apart where the epipole is there too.)
    Pixels count from the middle of the image, which is of one size for both.
    """

    F: np.ndarray
    """[3, 3], rightᵀ F left = 0."""
    middle: np.ndarray
    """[2], pixels of the image whose upper left pixel is (0, 0)."""
    size: tuple[int, int]

    @classmethod
    def of(cls, F: np.ndarray, view: rb.PinholeView) -> Pencils:
        """The pencils of a fundamental matrix between the images of a view."""
        to_corner = shift(*view.centre)
        return cls(to_corner.T @ F @ to_corner, view.centre, view.size)

    @cached_property
    def bases(self) -> tuple[np.ndarray, np.ndarray]:
        """[3, 2] each, left and right: w_0, which is 1 in the middle of the left image, and v, which is 0."""
        epipole = np.linalg.svd(self.F)[2][-1]
        epipole /= np.hypot(epipole[0], epipole[1])
        points = np.array([[-epipole[1], epipole[0], 0], [0, 0, 1]]).T
        return np.cross(epipole, points, axisb=0, axisc=0), self.F @ points

    @cached_property
    def variances(self) -> tuple[tuple[Polynomial, Polynomial], ...]:
        """(a, line) of each image: a(t)/line(t)² is the variance of w · x over its pixels, relative to its
        square in the middle. It is 0 where w is at infinity, and infinite where w meets the middle."""
        spread = (np.array([*self.size, 1]) ** 2 - 1) / 12  # of pixels; the third coordinate is 1 for all
        quadratics = [base.T @ (spread[:, None] * base) for base in self.bases]
        return tuple(
            (Polynomial([q[0, 0], 2 * q[0, 1], q[1, 1]]), Polynomial(base[2]))
            for q, base in zip(quadratics, self.bases, strict=True)
        )

    def projective_distortion(self, t: float) -> float:
        """Loop and Zhang's criterion of a pair, the sum of both images' variances."""
        return float(sum(a(t) / line(t) ** 2 for a, line in self.variances))

    def similar(self, t: float) -> tuple[np.ndarray, np.ndarray]:
        """The homographies [3, 3] of the pair w whose affine parts are similarities.

        Their scales have the geometric mean 1, and both images stay as upright as they can.
        """
        pairs = [np.stack([base[:, 1], base @ [1, t]]) for base in self.bases]
        pairs = [pair / pair[1, 2] for pair in pairs]  # w is 1 in the middle
        turns = np.array([v[:2] - v[2] * w[:2] for v, w in pairs])
        lengths = np.linalg.norm(turns, axis=1)
        scale = (1.0 if (turns[:, 1] / lengths).sum() >= 0 else -1.0) / np.sqrt(lengths.prod())
        left, right = (
            np.array([[scale * q, -scale * p, 0], scale * v, w])
            for (p, q), (v, w) in zip(turns, pairs, strict=True)
        )
        return left, right

    def of_kept_area(self, H_left: np.ndarray, H_right: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Both scaled by one factor, so that the images' areas have the sum they had."""
        w, h = self.size
        corners = np.array([[-w, -h], [w, -h], [w, h], [-w, h]]) / 2
        areas = [polygon_area(mapped(H, corners)) for H in (H_left, H_right)]
        scale = np.sqrt(2 * w * h / sum(areas))
        return np.diag([scale, scale, 1]) @ H_left, np.diag([scale, scale, 1]) @ H_right

    def between_pixels(self, H: np.ndarray) -> np.ndarray:
        """The same homography of pixels that count from the upper left one, on either side."""
        return shift(*self.middle) @ H @ shift(*-self.middle)

    def rectified(self, t: float) -> tuple[np.ndarray, np.ndarray]:
        """Loop and Zhang's homographies H_s H_r H_p between pixels [3, 3], of the pair w that t gives."""
        left, right = self.of_kept_area(*(sheared(H, self.size) for H in self.similar(t)))
        return self.between_pixels(left), self.between_pixels(right)


def shift(x: float, y: float) -> np.ndarray:
    """The homography that moves pixels."""
    return np.array([[1, 0, x], [0, 1, y], [0, 0, 1.0]])


def mapped(H: np.ndarray, pixels: np.ndarray) -> np.ndarray:
    """Pixels [N, 2] through a homography."""
    homogeneous = np.column_stack([pixels, np.ones(len(pixels))]) @ H.T
    return homogeneous[:, :2] / homogeneous[:, 2:]


def closest_columns(
    H: np.ndarray, pixels: np.ndarray, H_other: np.ndarray, px_other: np.ndarray
) -> np.ndarray:
    """The matrix of first row (a, b, c) that minimises the sum of (a x + b y + c - x')².

    Of matches [N, 2] each, (x, y) is where H brings a pixel, x' the column to which the other one goes.
    """
    x, y = mapped(H, pixels).T
    column = mapped(H_other, px_other)[:, 0]
    if not np.isfinite([x, y, column]).all():
        raise rb.Unsupported("a match is mapped to infinity: the epipole lies in the undistorted view")
    row, *_ = np.linalg.lstsq(np.column_stack([x, y, np.ones_like(x)]), column)
    return np.array([row, [0, 1, 0], [0, 0, 1]])


def sheared(H: np.ndarray, size: tuple[int, int]) -> np.ndarray:
    """H with columns a û + b v̂ that keep the image's two midlines across each other and the ratio of their
    lengths (Loop and Zhang's shear), the middle at û = 0; pixels count from the middle."""
    w, h = size
    ends = mapped(H, np.array([[w, 0], [-w, 0], [0, h], [0, -h]]) / 2)
    (x_u, x_v), (y_u, y_v) = ends[0] - ends[1], ends[2] - ends[3]
    area = h * w * (x_u * y_v - x_v * y_u)
    a = (h**2 * x_v**2 + w**2 * y_v**2) / area
    b = -(h**2 * x_u * x_v + w**2 * y_u * y_v) / area
    u = a * H[0] + b * H[1]
    return np.array([u - u[2] * H[2], H[1], H[2]])


def rows_rms_px(H_left: np.ndarray, left: np.ndarray, H_right: np.ndarray, right: np.ndarray) -> float:
    """How far the rows of matches [N, 2] are apart, root mean square."""
    apart = mapped(H_left, left)[:, 1] - mapped(H_right, right)[:, 1]
    return float(np.sqrt((apart**2).mean()))


def refuse_apart(rms_px: float, view: rb.PinholeView, found: str, expected: str) -> None:
    """Raise Unsupported where rows so far apart are no rectification."""
    if not rms_px <= WORST_ROWS_SHARE * view.size[1]:
        raise rb.Unsupported(f"{found} {rms_px:.1f} px between rows of {view.size[1]}; expected {expected}")


def polygon_area(corners: np.ndarray) -> float:
    """Of a polygon [N, 2]."""
    x, y = corners.T
    return float(abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2)
