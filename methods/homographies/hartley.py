"""Projective rectification from matches alone (Hartley 1999)."""

import numpy as np

import rectbench as rb

from ._homographies import closest_columns


class Hartley(rb.HomographyRectifier):
    """H' sends the right epipole to infinity, rigid to first order at the centre; H follows it closely."""

    name = "hartley"
    references = (
        "Hartley, Theory and Practice of Projective Rectification, "
        "International Journal of Computer Vision 35(2), 1999",
    )

    def homographies(
        self, view: rb.PinholeView, options: rb.Options
    ) -> tuple[np.ndarray, np.ndarray, dict[str, float | str]]:
        left, right = view.matches
        F = rb.fundamental_matrix(left, right)
        epipole = np.linalg.svd(F.T)[2][-1]  # e' with e'ᵀ F = 0
        H_right = epipole_to_infinity(epipole, view.centre)
        # F = [e']× M; adding e' vᵀ only changes what the affine row below chooses anyway.
        M = cross(epipole) @ F + np.outer(epipole, [1.0, 1.0, 1.0])
        H_0 = H_right @ M
        H_left = closest_columns(H_0, left, H_right, right) @ H_0
        return H_left, H_right, {}


def epipole_to_infinity(epipole: np.ndarray, centre: np.ndarray) -> np.ndarray:
    """G R T: centre to the origin, epipole onto the x axis by the smaller turn, then to infinity."""
    T = np.array([[1, 0, -centre[0]], [0, 1, -centre[1]], [0, 0, 1.0]])
    x, y, w = T @ epipole
    turn = -np.arctan2(y, x) if x >= 0 else -np.arctan2(-y, -x)
    R = np.array([[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
    along, _, w = R @ [x, y, w]
    G = np.array([[1, 0, 0], [0, 1, 0], [-w / along, 0, 1]])
    return np.linalg.inv(T) @ G @ R @ T


def cross(v: np.ndarray) -> np.ndarray:
    """[v]× with cross(v) @ x = v × x."""
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])
