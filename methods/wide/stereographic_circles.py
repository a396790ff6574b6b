"""Stereographic rectification (Heller and Pajdla 2009): a control, whose epipolar curves are circles."""

import numpy as np
from scipy.optimize import LinearConstraint, NonlinearConstraint, minimize

import rectbench as rb

from ._frames import held

OUTER_RAYS, LEFT_OUT = 24, 1e-10
"""Rays of the first cap; and by how much a ray may be farther off than those, cosines."""


class Options(rb.Options):
    focal_px: float | None = rb.option(
        None, "pixels a radian in the middle; the sources' centre resolution where left out", gt=0
    )


class StereographicCircles(rb.Rectifier[Options]):
    """(û, v̂) = 2 f (x, y) / (1 + z) of unit rays, z where no ray of the two views is far: conformal.

    It is the same in both images, so that the two images of a point lie on one circle through those of the
    epipoles. There are no scan lines: matchers have to search along circles, and row errors are distances
    between these.
    """

    name = "stereographic-circles"
    is_control = True
    references = (
        "Heller and Pajdla, Stereographic rectification of omnidirectional stereo pairs, CVPR 2009",
    )

    def fit(self, problem: rb.Problem, options: Options) -> rb.Rectification:
        """The scale of the map grows with the angle from the middle: the minimax location distorts least."""
        rig = problem.rig
        focal = options.focal_px or rb.centre_resolution_px(rig)
        rotations = rb.rectifying_rotations(rig)
        rays = np.concatenate(
            [
                camera.unproject(pixels)[0] @ R_rect_cam.T
                for camera, pixels, R_rect_cam in zip(
                    (rig.left, rig.right), (problem.pixels_left, problem.pixels_right), rotations, strict=True
                )
            ]
        )
        R_middle_rect = facing(minimax_location(rays))
        x, y, z = map(float, R_middle_rect[:, 0])
        circles = rb.EpipolarCircles(focal, 0.0, 0.0, baseline=(x, y, z))
        left, right = (
            rb.Warp(camera, R_middle_rect @ R_rect_cam, circles)
            for camera, R_rect_cam in zip((rig.left, rig.right), rotations, strict=True)
        )
        return held(rig, left, right, {"focal_px": focal})


def minimax_location(rays: np.ndarray) -> np.ndarray:
    """The unit vector [3] whose greatest angle to rays [N, 3] is least: the middle of their smallest cap.

    That of the rays farthest from their mean, and of each that it leaves out, until there is none.
    """
    middle = rays.mean(axis=0) / np.linalg.norm(rays.mean(axis=0))
    outer = rays[np.argsort(rays @ middle)[:OUTER_RAYS]]
    while True:
        middle = middle_of_cap(outer, middle)
        farthest = rays[(rays @ middle).argmin()]
        if farthest @ middle >= (outer @ middle).min() - LEFT_OUT:
            return middle
        outer = np.vstack([outer, farthest])


def middle_of_cap(rays: np.ndarray, start: np.ndarray) -> np.ndarray:
    """The unit vector c [3] of the greatest t with c·r ≥ t for all of some rays [K, 3]."""
    nearer = LinearConstraint(np.column_stack([rays, -np.ones(len(rays))]), 0.0, np.inf)
    unit = NonlinearConstraint(lambda x: x[:3] @ x[:3], 1.0, 1.0, jac=lambda x: 2 * np.append(x[:3], 0.0))
    found = minimize(  # type: ignore[call-overload]  # its stubs know constraints of one number
        lambda x: -x[3],
        np.append(start, (rays @ start).min()),
        jac=lambda x: np.array([0.0, 0.0, 0.0, -1.0]),
        method="SLSQP",
        constraints=[nearer, unit],
        options={"ftol": 1e-12},
    )
    middle: np.ndarray = found.x[:3] / np.linalg.norm(found.x[:3])
    return middle


def facing(direction: np.ndarray) -> np.ndarray:
    """The smallest rotation [3, 3] that turns a direction in front to z."""
    x, y, z = direction
    return np.array(
        [
            [1 - x * x / (1 + z), -x * y / (1 + z), -x],
            [-x * y / (1 + z), 1 - y * y / (1 + z), -y],
            [x, y, z],
        ]
    )
