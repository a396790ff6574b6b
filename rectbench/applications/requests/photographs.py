"""What the verbs for photographs and calibrations of one's own take."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Literal, Self

from pydantic import model_validator

from rectbench.applications.requests import words
from rectbench.applications.requests.request import (
    CALIBRATION,
    METHOD,
    METHOD_SEED,
    OUT,
    OptionsRequest,
    Positive,
    Request,
    RigRequest,
    Seed,
    SeededMethodRequest,
    SizedRigRequest,
    Text,
    positional,
    word,
)
from rectbench.errors import InvalidInput, argument
from rectbench.plugins.defaults import DEFAULT_METHOD, UNCALIBRATED_METHOD

BEST = "best"


def _check_images(left: str | Path | None, right: str | Path | None) -> None:
    """Raise InvalidInput for one image without the other."""
    if (left is None) != (right is None):
        both = f"{argument('left')} and {argument('right')}"
        only = f"one image was given, {left or right}"
        raise InvalidInput(f"{only}; expected {both}, or none and a calibration as {argument('rig')}")


class FramingRequest(Request):
    """What of a rectified pair is shown and how large: the fields of `Framing`."""

    crop: Literal["valid"] | tuple[float, float, float, float] | None = word(
        "Show the largest rectangle in which both images are valid, or one in pixels.",
        metavar="valid|X,Y,W,H",
        parse=words.crop_in,
    )
    fov_deg: tuple[float, float] | None = word(
        "Show a field of view, across and down, degrees.", "--fov", metavar="DEGxDEG", parse=words.angles_in
    )
    coverage: float | None = word("Show this share of the source pixels, up to 1.", metavar="SHARE")
    size: tuple[int, int] | None = word(
        "Size of the rectified images, pixels.", metavar="WxH", parse=words.size_in
    )
    focal_px: float | Literal["source"] | None = word(
        "Pixels per radian in the middle, or those of the source images there.",
        "--focal",
        metavar="PX|source",
        parse=words.focal_in,
    )
    pixels: float | None = word("Budget: a larger image is made smaller.", metavar="NUMBER")
    seam: Literal["cut", "wrap"] = word(
        "Where rows go all around the epipoles: cut there, or repeat some rows beyond.",
        default="cut",
        metavar="cut|wrap",
    )


class RectifyRequest(FramingRequest, OptionsRequest, RigRequest):
    """Photographs to be rectified into a folder; or a rig alone, of which all but the images is written."""

    size_field = "image_size"
    left: Text | None = positional("LEFT", "The left image, folder or pattern.", None)
    right: Text | None = positional("RIGHT", "The right one. Without both: tables for a rig.", None)
    rig: Any = word(
        f"{CALIBRATION} Without one, methods that work from matches alone.", metavar="CALIB", takes_rest=True
    )
    image_size: tuple[int, int] | None = word(
        "The source images' size, where there are none and the calibration does not tell.",
        metavar="WxH",
        parse=words.size_in,
    )
    out: Path = word("Folder for what is made.", *OUT, default=Path("rectified"))
    method: Text | None = word(
        "A method's name, or a file; or best: all that apply are measured, each showing --coverage of the "
        "source pixels (95 % where not given), and the least log distortion is chosen. "
        f"{DEFAULT_METHOD} by default, {UNCALIBRATED_METHOD} without a calibration.",
        *METHOD,
    )
    seed: Seed = word(METHOD_SEED, default=0)
    antialias: bool = word("Average over a pixel's footprint where the image shrinks.", default=False)
    tables: tuple[str, ...] = word(
        "Lookup tables: npz, opencv, fixed, separated by commas; or none.",
        default=("npz", "opencv", "fixed"),
        metavar="KINDS",
        parse=words.tables_in,
        has_commas=True,
    )
    measured_pairs: int = word(
        "Measure the rows of so many pairs, spread over all.",
        "--measure",
        default=5,
        metavar="PAIRS",
        least=0,
    )

    @model_validator(mode="after")
    def _checked(self) -> Self:
        _check_images(self.left, self.right)
        images = f"{argument('left')} and {argument('right')}"
        if self.left is None and self.rig is None:
            raise InvalidInput(
                f"there are no images and no calibration; expected {images}, or {argument('rig')}"
            )
        if self.left is None and self.antialias:
            raise InvalidInput(
                f"{argument('antialias')} is given without images; expected {images} beside it"
            )
        if self.left is not None and self.image_size is not None:
            raise InvalidInput(f"images tell their size themselves; expected no {argument('image_size')}")
        if self.method == BEST and self.options:
            given = f"{argument('options')} is given beside {argument('method', BEST)}"
            raise InvalidInput(f"{given}; expected it beside a method by its name")
        return self

    @property
    def method_name(self) -> str:
        """The method, or the usual one with or without a calibration."""
        return self.method or (UNCALIBRATED_METHOD if self.rig is None else DEFAULT_METHOD)


class PoseSettings(Request):
    """How a pose is found in two photographs; what is not set is as `pose_from_images` has it."""

    detector: Text = word("Of features: sift, akaze, orb or surf.", default="sift")
    ratio: Positive | None = word(
        "A match is nearer than the second best by this factor, 0.8 where not given."
    )
    farthest: Positive | None = word("No match's descriptors are farther apart than this.")
    working_pixels: Positive | None = word("A larger image is made as small before features are sought.")
    search: Text = word(
        "For what matches agree on: ransac, or inlier-set, the best there is within 30° of no turn.",
        default="ransac",
    )
    seed: Seed = word("Of the random samples.", default=0)


class PoseRequest(PoseSettings, RigRequest):
    """A pair whose pose is to be found."""

    left: Path = positional("LEFT", "The left image.")
    right: Path = positional("RIGHT", "The right image.")
    out: Path | None = word("Write the rig in this pose as YAML.", *OUT, metavar="FILE")


class ReconstructRequest(SeededMethodRequest, RigRequest):
    """A pair to be reconstructed in 3-D."""

    left: Path = positional("LEFT", "The left image.")
    right: Path = positional("RIGHT", "The right image.")
    out: Path = word("Folder for what is made.", *OUT, default=Path("reconstructed"))
    matcher: str = word("The dense matcher, by name or path, see `rectbench list matchers`.", default="sgbm")
    nearest_baselines: float = word("Nothing nearer is sought, in multiples of the baseline.", default=4.0)
    pixels: float = word("A rectified image of more pixels is made smaller first.", default=1e6)


class UncertaintyRequest(SeededMethodRequest, SizedRigRequest):
    """A calibration, and how sure it is: of a file, by sizes, or from two images."""

    left: Path | None = positional("LEFT", "The left image.", None)
    right: Path | None = positional("RIGHT", "The right image.", None)
    covariance: list[str] = word(
        "How sure the calibration is: YAML with sigmas or a covariance, Kalibr's results-cam.txt, or "
        "OpenCV's standard deviations, a file a camera, left first.",
        default=[],
        metavar="FILE",
    )
    rotation_deg: float | None = word("σ of the right camera's rotation, its size over all axes.", least=0)
    direction_deg: float | None = word("σ of the baseline's direction in the left camera's frame.", least=0)
    baseline_mm: float | None = word("σ of the baseline's length.", least=0)
    focal_px: float | None = word("σ of each camera's fx; fy moves along.", least=0)
    centre_px: float | None = word("σ of each camera's cx and cy.", least=0)
    out: Path = word("Folder for what is made.", *OUT, default=Path("uncertainty"))
    depth_m: list[float] | None = word(
        "Distances of the points seen, such as 1,10,inf; else 10 and 100 baselines and infinity.",
        metavar="METRES",
        parse=words.distances_in,
        has_commas=True,
    )
    matching_px: float = word("σ of a match's disparity, in rectified pixels.", default=0.25, least=0)

    @model_validator(mode="after")
    def _checked(self) -> Self:
        _check_images(self.left, self.right)
        return self

    @property
    def sigmas(self) -> dict[str, float]:
        """The stated sizes by the names that `RigCovariance.from_sigmas` has for them."""
        names = ("rotation_deg", "direction_deg", "baseline_mm", "focal_px", "centre_px")
        given = {name: sigma for name in names if (sigma := getattr(self, name)) is not None}
        if "baseline_mm" in given:
            given["baseline_m"] = given.pop("baseline_mm") / 1000
        return given


class ConvertRequest(SizedRigRequest):
    """A calibration to be written in another format."""

    out: Path = word("The file to write; for some formats a folder of files.", *OUT, default=...)
    to: str = word("See `rectbench list formats`.", default="native", metavar="FORMAT")
