"""Polar rectification, for any motion (Pollefeys, Koch and Van Gool 1999)."""

from typing import Literal

import rectbench as rb

from ._epipolar_lines import lossless, lossless_on_spheres
from ._epipolar_planes import EpipolarPlanes


class Options(rb.Options):
    form: Literal["auto", "planar", "spherical"] = rb.option(
        "auto",
        "planar: half epipolar lines of the images, as in the paper, of pinholes without distortion; "
        "spherical: half planes about the baseline, of any lenses; auto: planar where it can be",
    )


class Polar(rb.Rectifier[Options]):
    """Rows are half epipolar lines, as close as keeps every pixel, and keep their lengths: for any motion.

    A half plane about the baseline is a half epipolar line in both images, so that β matches the halves
    (the paper's oriented epipolar geometry). From line to line the paper moves by one pixel at the end that
    is farther from the epipole, in the image where that is less; v̂(β) is the number of such steps.
    """

    name = "polar"
    references = (
        "Pollefeys, Koch and Van Gool, A simple and efficient rectification method for general motion, "
        "ICCV 1999",
    )

    def fit(self, problem: rb.Problem, options: Options) -> rb.Rectification:
        """Raises Unsupported where keeping every pixel takes a larger image than there can be."""
        try:
            return self.lossless(problem, options)
        except rb.InvalidInput as reason:
            raise rb.Unsupported(f"to lose no source pixel, {reason}") from None

    def lossless(self, problem: rb.Problem, options: Options) -> rb.Rectification:
        """On planes or spheres, as the options and the lenses say."""
        planes = EpipolarPlanes.of(problem) if options.form != "spherical" else None
        if planes:
            beta = planes.beta()
            return planes.rectification("length", lossless(beta, planes.at_far_ends(beta)))
        if options.form == "planar":
            raise rb.Unsupported("form=planar works on images of pinholes without distortion; expected those")
        view = rb.view_angles(problem.rig)
        u, v = lossless_on_spheres(problem, view)
        return rb.Rectification.from_profiles(problem.rig, u, u, v, view=view)
