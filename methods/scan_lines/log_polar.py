"""Conformal rectification: of spheres (Geyer and Daniilidis 2003), of planes (Palander and Brandt 2008)."""

from typing import Literal

import numpy as np

import rectbench as rb

from ._epipolar_planes import EpipolarPlanes


class Options(rb.Options):
    form: Literal["spherical", "planar"] = rb.option(
        "spherical",
        "spherical: û = f artanh(sin γ), v̂ = f β, for any lens; planar: logarithms of distances from the "
        "epipole in the image and angles about it, as in the paper, for lenses that are pinholes",
    )
    focal_px: float | None = rb.option(
        None, "f of the spherical form in px; the sources' centre resolution where left out", gt=0
    )


class LogPolar(rb.Rectifier[Options]):
    """û = f artanh(sin γ), v̂ = f β: conformal on the sphere, as log-polar coordinates are in the plane.

    But for its scale this is the one map of a sphere that is conformal and has epipolar rows: the bipolar
    coordinates about both epipoles by which Geyer and Daniilidis rectify parabolic mirrors, for any central
    lens. About one epipole it is Palander and Brandt's logarithm of the distance, and the angle; what moves
    forward in front of the camera shifts, and hardly changes its size or its shape.
    """

    name = "log-polar"
    references = (
        "Geyer and Daniilidis, Conformal rectification of omnidirectional stereo pairs, OMNIVIS 2003",
        "Palander and Brandt, Epipolar geometry and log-polar transform in wide baseline stereo matching, "
        "ICPR 2008",
    )

    def fit(self, problem: rb.Problem, options: Options) -> rb.Rectification:
        if options.form == "planar":
            return self.on_planes(problem)
        focal = options.focal_px or rb.centre_resolution_px(problem.rig)
        u, v = rb.Radial("mercator", focal, 0.0), rb.Radial("equidistant", focal, 0.0)
        view = off_epipoles(rb.view_angles(problem.rig), 1 / focal)
        return rb.Rectification.from_profiles(problem.rig, u, u, v, {"focal_px": focal}, view=view)

    def on_planes(self, problem: rb.Problem) -> rb.Rectification:
        """Logarithms of radii about either epipole, and the angle about it, the mean of both images.

        On the arc through an image's farthest corner a pixel is as large as in the source.
        """
        planes = EpipolarPlanes.of(problem)
        if planes is None:
            raise rb.Unsupported("form=planar works on images of pinholes without distortion; expected those")
        beta = planes.beta()
        middles = np.concatenate([beta[:1], (beta[1:] + beta[:-1]) / 2, beta[-1:]])
        slopes = planes.on_arcs(middles).mean(axis=0)
        return planes.rectification("logarithm", rb.MonotoneSpline.of(beta, slopes))


def off_epipoles(view: rb.ViewAngles, margin: float) -> rb.ViewAngles:
    """The view less what is nearer to an epipole, where û is infinite, than a margin in radians."""
    reach = np.pi / 2 - margin
    left, right = (
        span._replace(low=max(span.low, -reach), high=min(span.high, reach))
        for span in (view.gamma_left, view.gamma_right)
    )
    return view._replace(gamma_left=left, gamma_right=right)
