"""Two views of rays: how far matches lie from an essential matrix, in pixels, and the poses in it.

A pose is (R, t): X_right = R X_left + t, t of length 1, and E = [t]× R.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from rectbench.cameras import Camera
from rectbench.types import BoolArray, FloatArray, Matches

BLOCK = 1 << 16
"""Numbers worked on at once. Larger arrays leave the cache, and products so thin gain nothing from the
threads that BLAS would then wake."""


class Pose(NamedTuple):
    """X_right = R X_left + t up to scale."""

    R: FloatArray
    """[3, 3]"""
    t: FloatArray
    """[3], of length 1."""

    def moved(self, step: FloatArray) -> Pose:
        """The pose after a small step [5]: a turn in the right frame (rad), then t across itself."""
        t = self.t + tangents(self.t) @ step[3:]
        return Pose(turn(step[:3]) @ self.R, t / np.linalg.norm(t))


@dataclass(frozen=True, eq=False)
class RayMatches:
    """Matches as rays, with what a pixel is worth there."""

    pixels: Matches
    """[N, 2] each."""
    left: FloatArray
    """Unit rays [N, 3]."""
    right: FloatArray
    """[N, 3]"""
    per_pixel_left: FloatArray
    """d(ray)/d(pixel) [N, 3, 2]."""
    per_pixel_right: FloatArray
    """[N, 3, 2]"""

    def __len__(self) -> int:
        return len(self.left)

    def __getitem__(self, kept: BoolArray | slice) -> RayMatches:
        pixels = Matches(self.pixels.left[kept], self.pixels.right[kept])
        rays = (self.left, self.right, self.per_pixel_left, self.per_pixel_right)
        return RayMatches(pixels, *(array[kept] for array in rays))

    @property
    def rad_per_px(self) -> FloatArray:
        """What a pixel of the right image spans [N], the root mean square over its directions."""
        span: FloatArray = np.linalg.norm(self.per_pixel_right, axis=(1, 2)) / np.sqrt(2)
        return span

    def mismatched(self, shift: int) -> RayMatches:
        """Wrong matches: the left pixel of each with the right pixel of another."""
        others = (self.pixels.right, self.right, self.per_pixel_right)
        px_right, rays, per_pixel = (np.roll(array, shift, axis=0) for array in others)
        pixels = Matches(self.pixels.left, px_right)
        return RayMatches(pixels, self.left, rays, self.per_pixel_left, per_pixel)

    @classmethod
    def of(cls, left: Camera, right: Camera, matches: Matches) -> tuple[RayMatches, BoolArray]:
        """The matches that both lenses see, and the mask [N] of these."""
        rays_left, ok_left = left.unproject(matches.left)
        rays_right, ok_right = right.unproject(matches.right)
        per_pixel = left.unproject_jacobian(matches.left), right.unproject_jacobian(matches.right)
        seen = ok_left & ok_right
        for jacobian in per_pixel:
            seen &= np.isfinite(jacobian).all(axis=(1, 2))
        return cls(matches, rays_left, rays_right, *per_pixel)[seen], seen

    def terms(self) -> FloatArray:
        """[9, 5, N]: times vec(E), the epipolar residual and its slopes by the four pixel coordinates.

        All five are linear in E, so that one matrix product serves many hypotheses.
        """
        slopes_left = np.moveaxis(self.per_pixel_left, -1, 0)
        slopes_right = np.moveaxis(self.per_pixel_right, -1, 0)
        pairs = [(self.right, self.left), *((self.right, slope) for slope in slopes_left)]
        pairs += [(slope, self.left) for slope in slopes_right]
        products = np.stack([b.T[:, None, :] * a.T[None, :, :] for b, a in pairs], axis=2)
        return products.reshape(9, 5, len(self))


def sampson_px(terms: FloatArray, matrices: FloatArray) -> FloatArray:
    """Signed Sampson distances [K, N] in source pixels of matches `terms` [9, 5, N] from E [K, 3, 3].

    First-order distance of the four pixel coordinates from the epipolar variety (Sampson 1982).
    """
    matrices, count = matrices.reshape(-1, 9), terms.shape[2]
    distances = np.empty((len(matrices), count))
    rows = max(1, BLOCK // terms[0].size)
    for first in range(0, len(matrices), rows):
        block = slice(first, first + rows)
        residual, *slopes = np.moveaxis((matrices[block] @ terms.reshape(9, -1)).reshape(-1, 5, count), 1, 0)
        steepness = np.sqrt(sum(slope * slope for slope in slopes))
        np.divide(residual, np.maximum(steepness, np.finfo(float).tiny), out=distances[block])
    return distances


def essential(pose: Pose) -> FloatArray:
    """E = [t]× R [3, 3]."""
    return cross_matrix(pose.t) @ pose.R


def essential_slopes(pose: Pose) -> FloatArray:
    """d vec(E) / d step [9, 5] for the steps of `Pose.moved`."""
    skew = cross_matrix(pose.t)
    turned = [skew @ cross_matrix(axis) @ pose.R for axis in np.eye(3)]
    shifted = [cross_matrix(tangent) @ pose.R for tangent in tangents(pose.t).T]
    return np.stack([slope.ravel() for slope in turned + shifted], axis=1)


def decomposed(matrix: FloatArray) -> tuple[Pose, Pose, Pose, Pose]:
    """The four poses with this essential matrix, up to its scale and sign."""
    U, _, Vt = np.linalg.svd(matrix)
    U, Vt = U * np.linalg.det(U), Vt * np.linalg.det(Vt)
    W = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    t = U[:, 2]
    first, second = U @ W @ Vt, U @ W.T @ Vt
    return Pose(first, t), Pose(first, -t), Pose(second, t), Pose(second, -t)


class Triangulation(NamedTuple):
    """Where the two rays of each match meet, all arrays [N]."""

    inverse_distance: FloatArray
    """Along the left ray, 1 / baselines; near 0 where the rays are parallel, negative behind."""
    ahead: BoolArray
    """Whether they meet ahead of both cameras."""
    parallax: FloatArray
    """The angle between them, as far as its sine."""
    alike: BoolArray
    """Whether they point to the same half of space."""


def triangulated(pose: Pose, matches: RayMatches) -> Triangulation:
    """Triangulation on the rays themselves, which point anywhere: no z decides what is ahead."""
    a, b = matches.left @ pose.R.T, matches.right
    # d_left a + t = d_right b, crossed with either ray.
    across = np.cross(a, b)
    square = (across**2).sum(axis=-1)
    along_left = (np.cross(b, pose.t) * across).sum(axis=-1)
    along_right = (np.cross(a, pose.t) * across).sum(axis=-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        inverse = np.where(along_left == 0, 0.0, square / along_left)
    ahead = (along_left > 0) & (along_right > 0)
    return Triangulation(inverse, ahead, np.sqrt(square), (a * b).sum(axis=-1) > 0)


def in_front(pose: Pose, matches: RayMatches, limit_px: float) -> BoolArray:
    """Cheirality: whether each match [N] may be a point ahead of both cameras, or too far to tell."""
    place = triangulated(pose, matches)
    return place.ahead | (place.alike & (place.parallax <= limit_px * matches.rad_per_px))


def tangents(direction: FloatArray) -> FloatArray:
    """Two orthonormal vectors across each unit vector, as columns [..., 3, 2]; smooth but for one pole."""
    x, y, z = np.moveaxis(direction, -1, 0)
    sign = np.where(z < 0, -1.0, 1.0)
    a = -1 / (sign + z)
    b = x * y * a
    # Duff et al., Building an Orthonormal Basis, Revisited, 2017.
    first = np.stack([1 + sign * x * x * a, sign * b, -sign * x], axis=-1)
    second = np.stack([b, sign + y * y * a, -y], axis=-1)
    return np.stack([first, second], axis=-1)


def cross_matrix(vector: FloatArray) -> FloatArray:
    """[v]× [3, 3]."""
    x, y, z = vector
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])


def turn(omega: FloatArray) -> FloatArray:
    """The rotation [3, 3] of a rotation vector, rad (Rodrigues)."""
    angle = float(np.linalg.norm(omega))
    skew = cross_matrix(omega)
    # sinc and its like: exact at no turn at all.
    half = np.sinc(angle / 2 / np.pi)
    return np.eye(3) + np.sinc(angle / np.pi) * skew + 0.5 * half * half * skew @ skew
