"""Methods for pinhole images, lifted to any lens: undistort, rectify there, compose the maps."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar

import numpy as np
from scipy.linalg import rq

from rectbench.cameras import Camera
from rectbench.errors import Unsupported
from rectbench.plugins.rectifier import OptionsT, Problem, Rectifier
from rectbench.rigs import Rig
from rectbench.types import FloatArray, Matches
from rectbench.warps.frame import centre_resolution_px, refuse_epipole_in_view
from rectbench.warps.rectification import Rectification, in_frame
from rectbench.warps.targets import Perspective
from rectbench.warps.view.extent import perspective_size
from rectbench.warps.warp import Warp

LEAST_MATCHES = 8


@dataclass(frozen=True, eq=False)
class PinholeView:
    """The pair as undistorted images of one ideal pinhole camera, with what is known of it there.

    Each image looks along its camera's axis. Both have the rig's mean resolution at the centre, the
    principal point in the middle and the larger camera's size, so that a method that assumes one
    focal length or a centred principal point is served; the field of view is stated in the notes.

    >>> import rectbench as rb
    >>> from rectbench.plugins.rectifier import pose_problem
    >>> view = rb.PinholeView.of(pose_problem(rb.load_rig("t265")))
    >>> view.size, round(view.fov_deg)
    ((848, 800), 112)
    """

    problem: Problem
    camera: Camera
    """The pinhole of both undistorted images; rectified images have its size."""

    @classmethod
    def of(cls, problem: Problem) -> PinholeView:
        """The view of a problem."""
        return cls(problem, _ideal_pinhole(problem.rig))

    @cached_property
    def rig(self) -> Rig:
        """The believed rig with this pinhole for both lenses, for methods that work from the pose."""
        return replace(self.problem.rig, left=self.camera, right=self.camera)

    @cached_property
    def matches(self) -> Matches:
        """[N, 2] each, pixels of the undistorted images.

        Raises Unsupported where fewer than 8 matches can be seen in both.
        """
        pixels, seen = [], []
        lenses = (self.problem.rig.left, self.problem.rig.right)
        for source, px in zip(lenses, self.problem.matches, strict=True):
            projected, ok = self.camera.project(source.unproject(px)[0])
            pixels.append(projected)
            seen.append(ok & self.camera.contains(projected))
        both = seen[0] & seen[1]
        if both.sum() < LEAST_MATCHES:
            raise Unsupported(
                f"{both.sum()} of {len(both)} matches can be seen in the undistorted views; "
                f"expected {LEAST_MATCHES} or more"
            )
        return Matches(pixels[0][both], pixels[1][both])

    @property
    def size(self) -> tuple[int, int]:
        """(width, height), pixels."""
        return self.camera.size

    @property
    def centre(self) -> FloatArray:
        """The middle of the image [2], pixels."""
        return (np.array(self.size) - 1) / 2

    @property
    def K(self) -> FloatArray:
        """The pinhole's matrix [3, 3], pixels from rays."""
        p = self.camera.params
        return np.array([[p["fx"], 0, p["cx"]], [0, p["fy"], p["cy"]], [0, 0, 1.0]])

    @property
    def fov_deg(self) -> float:
        """Horizontal field of view, degrees."""
        return float(np.degrees(2 * np.arctan(self.size[0] / 2 / self.K[0, 0])))


def _ideal_pinhole(rig: Rig) -> Camera:
    width, height = size = perspective_size(rig)
    focal = centre_resolution_px(rig)
    return Camera("pinhole", size, {"fx": focal, "fy": focal, "cx": (width - 1) / 2, "cy": (height - 1) / 2})


class HomographyRectifier(Rectifier[OptionsT]):
    """Base of the methods that find a pair of homographies between pinhole images.

    They work from the matches, or from the pose of `view.rig` where their `needs` say so.

    >>> import numpy as np
    >>> import rectbench as rb
    >>> class Identity(rb.HomographyRectifier):
    ...     name = "identity"
    ...     def homographies(self, view, options):
    ...         return np.eye(3), np.eye(3), {"matches": float(len(view.matches.left))}
    """

    needs: ClassVar[frozenset[str]] = frozenset({"matches"})

    @abstractmethod
    def homographies(
        self, view: PinholeView, options: OptionsT
    ) -> tuple[FloatArray, FloatArray, Mapping[str, float | str]]:
        """H_left, H_right [3, 3] from undistorted to rectified pixels, and the method's notes."""

    def placement(self, view: PinholeView, H_left: FloatArray, H_right: FloatArray) -> FloatArray:
        """What moves both rectified images into the frame [3, 3], after their homographies.

        Here the shift that brings the mean of the views' middles to the middle of the frame; a method whose
        authors place the images themselves gives the identity.
        """
        return _centring(view.centre, H_left, H_right)

    def fit(self, problem: Problem, options: OptionsT) -> Rectification:
        """The homographies of the undistorted views, composed with the lenses."""
        view = PinholeView.of(problem)
        _require_no_epipole(view.rig)
        H_left, H_right, notes = self.homographies(view, options)
        placement = self.placement(view, H_left, H_right)
        warps = [
            _turned(camera, placement @ H @ view.K)
            for camera, H in ((problem.rig.left, H_left), (problem.rig.right, H_right))
        ]
        _require_both_shown(problem, warps, view.size)
        stated = {"view_fov_deg": view.fov_deg}
        if "matches" in self.needs:
            stated["view_matches"] = float(len(view.matches.left))
        return Rectification(problem.rig, warps[0], warps[1], view.size, {**notes, **stated})


def _require_no_epipole(rig: Rig) -> None:
    """Raise Unsupported where the undistorted views show an epipole: no homography sends it to infinity
    without sending there what is about it."""
    try:
        refuse_epipole_in_view(rig)
    except Unsupported:
        raise Unsupported(
            "an epipole lies in the undistorted view, which no homography can rectify; expected a method "
            "of scan lines on the sphere"
        ) from None


def _require_both_shown(problem: Problem, warps: Sequence[Warp], size: tuple[int, int]) -> None:
    """Raise Unsupported where an image is turned out of the frame, or mirrored in it."""
    for warp, pixels in zip(warps, (problem.pixels_left, problem.pixels_right), strict=True):
        shown = in_frame(warp.forward(pixels), size)
        if not shown.any() or not (np.linalg.det(warp.jacobian(pixels[shown])) > 0).all():
            raise Unsupported(
                "no pair of homographies shows both undistorted views, so far do the cameras look apart; "
                "expected a method of scan lines on the sphere"
            )


def _centring(centre: FloatArray, H_left: FloatArray, H_right: FloatArray) -> FloatArray:
    """The shift, one for both images, that brings the middles of the views to the middle of the output."""
    middles = []
    for H in (H_left, H_right):
        u, v, w = H @ [*centre, 1.0]
        middles.append([u / w, v / w])
    shift = centre - np.mean(middles, axis=0)
    return np.array([[1, 0, shift[0]], [0, 1, shift[1]], [0, 0, 1.0]])


def _turned(camera: Camera, P: FloatArray) -> Warp:
    """The warp of pixels from rays P = T R, split into the rotation R and an upper triangular T.

    A homography of a pinhole image is a turned camera with other intrinsics: for a quasi-Euclidean
    method those it meant, for a projective one those it amounts to. The sign, which a homography
    leaves free, is the one that shows what the camera looks at.
    """
    T, R = rq(P * (1.0 if P[2, 2] > 0 else -1.0))
    signs = np.sign(np.diag(T))
    signs[0] *= np.linalg.det(signs[:, None] * R)  # a mirrored image is mirrored by T, never by R
    return Warp(camera, signs[:, None] * R, Perspective(np.asarray(T * signs, dtype=np.float64)))
