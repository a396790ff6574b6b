"""Rectification of spheres, whose epipoles become the poles (Fujiki 2007, Arican and Frossard 2007)."""

from typing import Literal

import rectbench as rb


class Options(rb.Options):
    grid: Literal["square", "equiangular"] = rb.option(
        "square",
        "square: as many pixels a radian along the meridians as across them; equiangular: 2B x 2B samples of "
        "the whole sphere, which are twice as many along",
    )
    focal_px: float | None = rb.option(
        None, "pixels a radian across the meridians; the sources' centre resolution where left out", gt=0
    )


class Spherical(rb.Rectifier[Options]):
    """Both spheres are turned so that their epipoles are the poles: rows are meridians, û the way along them.

    û = c_x + f_x γ, v̂ = c_y + f_y β, where γ + 90° is the colatitude θ and β the longitude φ. With a square
    grid this is the equidistant map of Abraham and Förstner, as mrcal's LATLON is; OpenCV's LONGLATI differs
    by its scales. Both papers show whole spheres; the frame here holds the part that the lenses show.
    """

    name = "spherical"
    references = (
        "Fujiki, Torii and Akaho, Epipolar geometry via rectification of spherical images, MIRAGE 2007",
        "Arican and Frossard, Dense disparity estimation from omnidirectional images, AVSS 2007",
    )

    def fit(self, problem: rb.Problem, options: Options) -> rb.Rectification:
        focal = options.focal_px or rb.centre_resolution_px(problem.rig)
        along = {"square": 1, "equiangular": 2}[options.grid]  # θ goes over π, φ over 2π
        u, v = rb.Radial("equidistant", along * focal, 0.0), rb.Radial("equidistant", focal, 0.0)
        return rb.Rectification.from_profiles(problem.rig, u, u, v, {"focal_px": focal})
