"""The family of Theorem 1 leaves rows alone, nothing else does, and the figure shows both."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from rectbench.reporting.charts.theorems import (
    CROSS,
    examples,
    image_of,
    keeps_planes,
    point_rays,
    theorem_1,
)

entries = st.floats(-2, 2)


def partners(A: np.ndarray) -> np.ndarray:
    """All A' with A'ᵀ [e]× A ~ [e]×, by brute force: the null space [9, K] of nine linear equations."""
    equations = np.zeros((9, 10))  # the nine entries of A', and the scale
    for place in range(9):
        unit = np.eye(9)[place].reshape(3, 3)
        equations[:, place] = (unit.T @ CROSS @ A).ravel()
    equations[:, 9] = -CROSS.ravel()
    _, singular, V = np.linalg.svd(equations)
    free = V[np.concatenate([singular, [0.0]]) < 1e-9]
    return free[:, :9].T


@given(
    st.lists(entries, min_size=6, max_size=6), st.lists(entries, min_size=4, max_size=4), st.floats(0.2, 3)
)
def test_every_pair_of_the_family_keeps_planes(rows: list[float], block: list[float], factor: float) -> None:
    block_2x2 = np.eye(2) + 0.2 * np.reshape(block, (2, 2))
    A, A_right = theorem_1(np.array(rows[:3]), np.array(rows[3:]), block_2x2, factor)
    assert keeps_planes(A, A_right) or abs(np.linalg.det(block_2x2)) < 1e-6
    assert not keeps_planes(A, A_right + 0.1 * np.eye(3)[[1, 2, 0]])


def test_whoever_keeps_planes_is_of_the_family() -> None:
    """Solved for A' by brute force: its first row is free, its block the other's, its first column empty."""
    rng = np.random.default_rng(0)
    for _ in range(50):
        A = theorem_1(rng.normal(size=3), rng.normal(size=3), rng.normal(size=(2, 2)))[0]
        found = partners(A)
        assert found.shape[1] == 4  # three numbers of the first row, and λ
        for solution in found.T.reshape(-1, 3, 3):
            np.testing.assert_allclose(solution[1:, 0], 0, atol=1e-9)
            off = solution[1:, 1:].ravel(), A[1:, 1:].ravel()
            assert np.linalg.matrix_rank(np.stack(off), tol=1e-8) <= 1


def test_outside_the_family_no_partner_is_invertible() -> None:
    rng = np.random.default_rng(1)
    for _ in range(50):
        A = rng.normal(size=(3, 3))  # its lower left is not zero
        basis = partners(A)
        mixed = np.einsum("ik,k->i", basis, rng.normal(size=basis.shape[1])).reshape(3, 3)
        assert abs(np.linalg.det(mixed)) < 1e-9


def test_first_rows_move_columns_alone() -> None:
    rays = point_rays().left
    block, rng = np.array([[1.0, 0.2], [0.1, 1.2]]), np.random.default_rng(2)
    one, other = theorem_1(rng.normal(size=3), rng.normal(size=(*rays.shape[:-1], 3)), block)
    np.testing.assert_allclose(image_of(one, rays)[..., 1], image_of(other, rays)[..., 1], rtol=1e-12)
    assert np.abs(image_of(one, rays)[..., 0] - image_of(other, rays)[..., 0]).max() > 1


def test_the_pictures_keep_rows_where_they_say_so_and_lose_them_in_the_last() -> None:
    *kept, lost = examples(point_rays())
    assert max(example.row_error for example in kept) < 1e-12
    assert lost.row_error > 0.05
    columns = [example.left[..., 0] for example in kept]
    assert all(np.abs(columns[0] - others).max() > 0.1 for others in columns[1:])


def test_a_pixel_variant_choice_is_the_equidistant_epipolar_image() -> None:
    rays = point_rays()
    picture = examples(rays)[2].left
    x, y, z = np.moveaxis(rays.left, -1, 0)
    np.testing.assert_allclose(picture[..., 0], np.arctan2(x, np.hypot(y, z)), atol=1e-12)
    np.testing.assert_allclose(picture[..., 1], np.arctan2(y, z), atol=1e-12)
