"""What the verbs for photographs and calibrations of one's own take."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, model_validator

from rectbench.applications.requests.request import Request, Word, positional
from rectbench.applications.requests.shared import (
    LeftImage,
    MethodSeed,
    OptionsRequest,
    Out,
    Positive,
    RightImage,
    RigRequest,
    Seed,
    SeededMethodRequest,
    SizedRigRequest,
    Text,
)
from rectbench.applications.requests.words import angles_in, crop_in, distances_in, focal_in, size_in
from rectbench.errors import InvalidInput

BEST = "best"
_TABLES = BeforeValidator(lambda kinds: () if list(kinds) == ["none"] else tuple(kinds))


class FramingRequest(Request):
    """What of a rectified pair is shown and how large: the fields of `Framing`."""

    crop: Annotated[
        Literal["valid"] | tuple[float, float, float, float] | None,
        BeforeValidator(crop_in),
        Word(metavar="valid|X,Y,W,H"),
    ] = Field(
        None, description="Show the largest rectangle in which both images are valid, or one in pixels."
    )
    fov_deg: Annotated[
        tuple[float, float] | None, BeforeValidator(angles_in), Word(("--fov",), metavar="DEGxDEG")
    ] = Field(None, description="Show a field of view, across and down, degrees.")
    coverage: Annotated[float | None, Word(metavar="SHARE")] = Field(
        None, description="Show this share of the source pixels, up to 1."
    )
    size: Annotated[tuple[int, int] | None, BeforeValidator(size_in), Word(metavar="WxH")] = Field(
        None, description="Size of the rectified images, pixels."
    )
    focal_px: Annotated[
        float | Literal["source"] | None,
        BeforeValidator(focal_in),
        Word(("--focal",), metavar="PX|source"),
    ] = Field(None, description="Pixels per radian in the middle, or those of the source images there.")
    pixels: Annotated[float | None, Word(metavar="NUMBER")] = Field(
        None, description="Budget: a larger image is made smaller."
    )


class RectifyRequest(FramingRequest, OptionsRequest, RigRequest):
    """Photographs to be rectified into a folder."""

    left: Annotated[Text, positional("LEFT"), Field(description="The left image, folder or pattern.")]
    right: Annotated[Text, positional("RIGHT"), Field(description="The right one.")]
    rig: Annotated[Any, Word(metavar="CALIB", takes_rest=True)] = Field(
        None,
        description=f"{RigRequest.model_fields['rig'].description} "
        "Without one, methods that work from matches alone.",
    )
    out: Out = Field(Path("rectified"), description="Folder for what is made.")
    method: Annotated[Text | None, Word(("--method", "-m"))] = Field(
        None,
        description="A method's name, or a file; or best: all that apply are measured, each showing "
        "--coverage of the source pixels (95 % where not given), and the least log distortion is chosen. "
        "local-homography by default, hartley without a calibration.",
    )
    seed: MethodSeed = 0
    antialias: bool = Field(False, description="Average over a pixel's footprint where the image shrinks.")
    tables: Annotated[tuple[str, ...], _TABLES, Word(metavar="KINDS", has_commas=True)] = Field(
        ("npz", "opencv", "fixed"),
        description="Lookup tables: npz, opencv, fixed, separated by commas; or none.",
    )
    measured_pairs: Annotated[int, Word(("--measure",), metavar="PAIRS")] = Field(
        5, ge=0, description="Measure the rows of so many pairs, spread over all."
    )

    @model_validator(mode="after")
    def _checked(self) -> Self:
        if self.method == BEST and self.options:
            raise InvalidInput("options are given for method best; expected them for a method by its name")
        return self

    @property
    def method_name(self) -> str:
        """The method, or the usual one with or without a calibration."""
        return self.method or ("hartley" if self.rig is None else "local-homography")


class PoseSettings(Request):
    """How a pose is found in two photographs; what is not set is as `pose_from_images` has it."""

    detector: Text = Field("sift", description="Of features: sift, akaze, orb or surf.")
    ratio: Positive | None = Field(
        None, description="A match is nearer than the second best by this factor, 0.8 where not given."
    )
    farthest: Positive | None = Field(None, description="No match's descriptors are farther apart than this.")
    working_pixels: Positive | None = Field(
        None, description="A larger image is made as small before features are sought."
    )
    seed: Seed = Field(0, description="Of the random samples.")


class PoseRequest(PoseSettings, RigRequest):
    """A pair whose pose is to be found."""

    left: LeftImage
    right: RightImage
    out: Annotated[Path | None, Word(("--out", "-o"), metavar="FILE")] = Field(
        None, description="Write the rig in this pose as YAML."
    )


class ReconstructRequest(SeededMethodRequest, RigRequest):
    """A pair to be reconstructed in 3-D."""

    left: LeftImage
    right: RightImage
    out: Out = Field(Path("reconstructed"), description="Folder for what is made.")
    matcher: str = Field("sgbm", description="The dense matcher: sgbm, sgbm-5way, sgbm-8way or bm.")
    nearest_baselines: float = Field(
        4.0, description="Nothing nearer is sought, in multiples of the baseline."
    )
    pixels: float = Field(1e6, description="A rectified image of more pixels is made smaller first.")


class UncertaintyRequest(SeededMethodRequest, SizedRigRequest):
    """A calibration, and how sure it is: of a file, by sizes, or from two images."""

    left: Annotated[Path | None, positional("LEFT")] = Field(None, description="The left image.")
    right: Annotated[Path | None, positional("RIGHT")] = Field(None, description="The right image.")
    covariance: Annotated[list[str], Word(metavar="FILE")] = Field(
        [],
        description="How sure the calibration is: YAML with sigmas or a covariance, Kalibr's "
        "results-cam.txt, or OpenCV's standard deviations, a file a camera, left first.",
    )
    rotation_deg: float | None = Field(
        None, ge=0, description="σ of the right camera's rotation, its size over all axes."
    )
    direction_deg: float | None = Field(
        None, ge=0, description="σ of the baseline's direction in the left camera's frame."
    )
    baseline_mm: float | None = Field(None, ge=0, description="σ of the baseline's length.")
    focal_px: float | None = Field(None, ge=0, description="σ of each camera's fx; fy moves along.")
    centre_px: float | None = Field(None, ge=0, description="σ of each camera's cx and cy.")
    out: Out = Field(Path("uncertainty"), description="Folder for what is made.")
    depth_m: Annotated[
        list[float] | None, BeforeValidator(distances_in), Word(metavar="METRES", has_commas=True)
    ] = Field(
        None,
        description="Distances of the points seen, such as 1,10,inf; else 10 and 100 baselines and infinity.",
    )
    matching_px: float = Field(0.25, ge=0, description="σ of a match's disparity, in rectified pixels.")

    @model_validator(mode="after")
    def _checked(self) -> Self:
        if (self.left is None) != (self.right is None):
            raise InvalidInput(f"one image was given, {self.left}; expected LEFT and RIGHT, or none")
        return self

    @property
    def sigmas(self) -> dict[str, float]:
        """The stated sizes by the names that `RigCovariance.from_sigmas` has for them."""
        sizes = {
            "rotation_deg": self.rotation_deg,
            "direction_deg": self.direction_deg,
            "baseline_m": None if self.baseline_mm is None else self.baseline_mm / 1000,
            "focal_px": self.focal_px,
            "centre_px": self.centre_px,
        }
        return {name: sigma for name, sigma in sizes.items() if sigma is not None}


class ConvertRequest(SizedRigRequest):
    """A calibration to be written in another format."""

    out: Out = Field(description="The file to write; for some formats a folder of files.")
    to: Annotated[str, Word(metavar="FORMAT")] = Field("native", description="See `rectbench list formats`.")
