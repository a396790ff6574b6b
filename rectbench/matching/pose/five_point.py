"""Essential matrices from five pairs of rays, many samples at once.

Li and Hartley, Five-Point Motion Estimation Made Easy, ICPR 2006: of the four coordinates of E in the
null space of the five epipolar equations one is hidden, the ten cubic constraints become C(z) v = 0 in
the ten monomials v of the others, and det C(z) = 0 is solved for z. Here det C(z) is not expanded: it
is the characteristic polynomial of a 10x10 matrix, whose eigenvectors hold the other coordinates too.
"""

from __future__ import annotations

from itertools import product

import numpy as np
from numpy.typing import NDArray

from rectbench.types import FloatArray

POLISHING_STEPS = 4
REAL = 1e-3
"""An eigenvalue with a larger imaginary share stands for no real solution."""
RIDGE = 1e-13
"""Share of its trace that makes the normal matrix of a degenerate sample invertible."""
SOLVED = 1e-9
"""Left of the constraints where a solution has been polished; it is 1e-15 as a rule."""


def _monomials() -> tuple[NDArray[np.intp], FloatArray]:
    """Exponents as three factors [20, 3] of (x, y, z, w), and the sum of 64 products into them [20, 64].

    The ten without z come first, then z times (xx, xy, yy, xw, yw, ww), zz times (x, y, w), zzz.
    """
    x, y, z, w = range(4)
    plain = [(x, x, x), (x, x, y), (x, y, y), (y, y, y), (x, x, w), (x, y, w), (y, y, w)]
    plain += [(x, w, w), (y, w, w), (w, w, w)]
    hidden = [(x, x, z), (x, y, z), (y, y, z), (x, w, z), (y, w, z), (w, w, z)]
    hidden += [(x, z, z), (y, z, z), (w, z, z), (z, z, z)]
    place = {tuple(sorted(factors)): i for i, factors in enumerate(plain + hidden)}
    sums = np.zeros((20, 64))
    for column, factors in enumerate(product(range(4), repeat=3)):
        sums[place[tuple(sorted(factors))], column] = 1
    return np.array(plain + hidden), sums


FACTORS, SUMS = _monomials()


def essential_matrices(rays_left: FloatArray, rays_right: FloatArray) -> tuple[FloatArray, NDArray[np.intp]]:
    """All real E [K, 3, 3], Frobenius norm 1, with ray_rightᵀ E ray_left = 0 for a sample of five.

    Rays are unit vectors [B, 5, 3] in any directions, 90 degrees off the axis and more included. Also
    returns which sample each matrix solves [K], ascending; a sample has up to ten. A degenerate sample
    may have none, or some that mean nothing.
    """
    equations = (rays_right[..., :, None] * rays_left[..., None, :]).reshape(-1, 5, 9)
    complete, _ = np.linalg.qr(np.swapaxes(equations, 1, 2), mode="complete")
    basis = np.swapaxes(complete[:, :, 5:], 1, 2).reshape(-1, 4, 3, 3)
    constraints = _constraints(basis)
    coordinates, sample = _solutions(constraints)
    coordinates, residual = _polished(coordinates, constraints[sample])
    solved = residual < SOLVED
    sample = sample[solved]
    matrices = np.einsum("kb,kbij->kij", coordinates[solved], basis[sample])
    return matrices, sample


def _constraints(basis: FloatArray) -> FloatArray:
    """Coefficients [B, 10, 20] of det E = 0 and 2 E Eᵀ E = tr(E Eᵀ) E over the 20 monomials."""
    count = len(basis)
    gram = np.einsum("biac,bjdc->bijad", basis, basis)
    gram -= 0.5 * np.trace(gram, axis1=-2, axis2=-1)[..., None, None] * np.eye(3)
    traces = np.einsum("bijac,blcd->badijl", gram, basis).reshape(count, 9, 64)
    cross = np.cross(basis[:, :, None, 0], basis[:, None, :, 1])
    determinant = np.einsum("bijc,blc->bijl", cross, basis[:, :, 2]).reshape(count, 1, 64)
    return np.concatenate([traces, determinant], axis=1) @ SUMS.T


def _solutions(constraints: FloatArray) -> tuple[FloatArray, NDArray[np.intp]]:
    """Coordinates (x, y, z, w) [K, 4] of unit length, to be polished, and their samples [K]."""
    plain, hidden = constraints[..., :10], constraints[..., 10:]
    usable = np.flatnonzero(np.abs(np.linalg.det(plain)) > np.finfo(float).tiny)
    # plain v + hidden m = 0 gives v from m; and m / z holds the last six of v, then four of m itself.
    companion = np.zeros((len(usable), 10, 10))
    companion[:, :6] = -np.linalg.solve(plain[usable], hidden[usable])[:, 4:]
    companion[:, [6, 7, 8, 9], [3, 4, 5, 8]] = 1
    values, vectors = np.linalg.eig(companion)
    real = np.abs(values.imag) <= REAL * np.abs(values)
    index, column = np.nonzero(real)
    x, y, w, z = vectors[index, 6:, column].real.T
    coordinates = np.stack([x, y, z, w], axis=-1)
    length = np.linalg.norm(coordinates, axis=-1, keepdims=True)
    kept = length[:, 0] > 0
    return coordinates[kept] / length[kept], usable[index[kept]]


def _polished(coordinates: FloatArray, constraints: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Gauss-Newton on the ten constraints over the unit sphere; the coordinates and what is left [K]."""
    for _ in range(POLISHING_STEPS):
        a, b, c = (coordinates[:, FACTORS[:, k]] for k in range(3))
        slopes = np.zeros((*coordinates.shape, 20))
        for factor, others in zip(FACTORS.T, (b * c, a * c, a * b), strict=True):
            slopes[:, factor, np.arange(20)] += others
        jacobian = constraints @ np.swapaxes(slopes, 1, 2)
        residual = constraints @ (a * b * c)[..., None]
        transposed = np.swapaxes(jacobian, 1, 2)
        # The constraints are homogeneous: J is singular along the solution itself, x xᵀ fills in.
        normal = transposed @ jacobian + coordinates[:, :, None] * coordinates[:, None, :]
        trace = np.trace(normal, axis1=1, axis2=2)
        normal += RIDGE * trace[:, None, None] * np.eye(4)
        step = np.linalg.solve(normal, -transposed @ residual)[..., 0]
        coordinates = coordinates + step
        coordinates /= np.linalg.norm(coordinates, axis=1, keepdims=True)
    a, b, c = (coordinates[:, FACTORS[:, k]] for k in range(3))
    left = constraints @ (a * b * c)[..., None]
    return coordinates, np.linalg.norm(left[..., 0], axis=-1)
