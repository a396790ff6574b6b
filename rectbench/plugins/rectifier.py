"""What a rectifier is: typed options, a problem in, a rectification out."""

from __future__ import annotations

import inspect
from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar, Generic, get_args

import numpy as np
from pydantic import BaseModel, ConfigDict, Field
from typing_extensions import TypeVar

from rectbench.cameras import Camera
from rectbench.errors import InvalidInput
from rectbench.margin import MARGIN_DEG
from rectbench.registry.kind import Described, Kind, Plugin, described_object
from rectbench.rigs import Rig
from rectbench.types import FloatArray, Images, Matches
from rectbench.warps.frame import rectifying_rotations
from rectbench.warps.rectification import Rectification
from rectbench.warps.targets import ANGLES
from rectbench.warps.view.overlap import require_overlap
from rectbench.warps.view.sampling import evaluation_pixels
from rectbench.warps.warp import Warp


class Options(BaseModel):
    """Base of a rectifier's options: typed, checked, immutable; no unknown ones.

    >>> import rectbench as rb
    >>> class ScaleOptions(rb.Options):
    ...     scale: float = rb.option(1.0, "pixels of output for one of source", gt=0)
    >>> ScaleOptions(scale=2)
    ScaleOptions(scale=2.0)
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


def option(default: Any, description: str, **limits: Any) -> Any:
    """One option: its default, what it does, and its limits (`ge`, `gt`, `le`, `lt`).

    >>> class Mine(Options):
    ...     scale: float = option(1.0, "pixels of output for one of source", gt=0)
    >>> Mine().scale
    1.0
    """
    return Field(default, description=description, **limits)


@dataclass(frozen=True, eq=False)
class Problem:
    """All that a rectifier may know; never the truth.

    >>> import rectbench as rb
    >>> from rectbench.plugins.rectifier import pose_problem
    >>> problem = pose_problem(rb.load_rig("t265"))
    >>> problem.pixels_left.shape, problem.matches.left.shape
    ((489, 2), (1999, 2))
    >>> left, right = problem.angle_warps()
    >>> left.forward(problem.pixels_left[:1]).round(2)  # γ and β, radians
    array([[-0.36, -1.38]])
    """

    rig: Rig
    """The rig as calibrated or estimated, which may be off; blind about its epipoles where it sees any.

    `rig.whole` is the same with all that the lenses show, for maps that keep the epipoles apart."""
    pixels_left: FloatArray
    """[N, 2] source pixels whose distortion counts."""
    pixels_right: FloatArray
    """[N, 2]"""
    known_matches: Matches | None = None
    """Corresponding pixels, with their noise, where somebody found some."""
    images: Images | None = None
    seed: int = 0

    @cached_property
    def matches(self) -> Matches:
        """The known matches; without any, exact ones made from the believed pose."""
        return self.known_matches if self.known_matches is not None else matches_from_pose(self.rig)

    def angle_warps(self) -> tuple[Warp, Warp]:
        """Both cameras' maps from pixels to (γ, β) in radians: what a row-keeping method starts from."""
        R_rect_left, R_rect_right = rectifying_rotations(self.rig)
        return Warp(self.rig.left, R_rect_left, ANGLES), Warp(self.rig.right, R_rect_right, ANGLES)


def pose_problem(
    rig: Rig,
    *,
    pixels: FloatArray | None = None,
    matches: Matches | None = None,
    images: Images | None = None,
    seed: int = 0,
    margin_deg: float = MARGIN_DEG,
) -> Problem:
    """The problem for a rig; what is left out is the usual: evaluation pixels, matches made from the pose.

    The rig is trimmed by the margin, see `Rig.trimmed`. Of given pixels each image uses those its lens sees;
    InvalidInput where it sees none. Raises Unsupported where the two views have nothing in common.
    """
    rig = rig.trimmed(margin_deg)
    require_overlap(rig)
    left, right = (_pixels_of(getattr(rig, side), pixels, side) for side in ("left", "right"))
    return Problem(rig, left, right, matches, images, seed)


def _pixels_of(camera: Camera, pixels: FloatArray | None, side: str) -> FloatArray:
    """The given pixels that the lens sees, or the evaluation grid."""
    if pixels is None:
        return evaluation_pixels(camera)
    seen = pixels[camera.unproject(pixels)[1]]
    if not len(seen):
        raise InvalidInput(
            f"the {side} lens sees none of the {len(pixels)} pixels; expected pixels of the image"
        )
    return seen


NEAR_IN_BASELINES, FAR_IN_BASELINES = 5.0, 200.0


def matches_from_pose(rig: Rig, count: int = 2000) -> Matches:
    """Where points at 5 to 200 baselines would be seen by the believed rig: noise-free, both images.

    Methods that know no pose but only matches can so run on a calibrated rig without images.
    """
    pixels = evaluation_pixels(rig.left, count)
    rays, _ = rig.left.unproject(pixels)
    # A fixed low-discrepancy sequence (golden ratio): depths spread evenly, without a random stream.
    share = (np.arange(len(pixels)) * 0.6180339887498949) % 1.0
    depths = rig.baseline_m / (share / NEAR_IN_BASELINES + (1 - share) / FAR_IN_BASELINES)
    points_right = rig.right_from_left(rays * depths[:, None])
    pixels_right, ok = rig.right.project(points_right)
    seen = ok & rig.right.contains(pixels_right)
    return Matches(pixels[seen], pixels_right[seen])


OptionsT = TypeVar("OptionsT", bound=Options, default=Any)


class Rectifier(ABC, Generic[OptionsT]):
    """A stereo rectification method: one file, one class.

    The class's docstring says in its first line what the method is. `needs` says what it works from:
    "pose" for a calibrated method, "matches" for one that finds the geometry by itself. `is_control` says
    that the rows of its images are no epipolar planes, knowingly: it is scored as any other, row errors and
    all, and is not ranked.

    A method's options are a subclass of `Options`, named in brackets, so that a type checker holds `fit` to
    them, or nested in the class under the name `Options`.

    >>> import rectbench as rb
    >>> class ScaleOptions(rb.Options):
    ...     scale: float = rb.option(1.0, "pixels of output for one of source", gt=0)
    >>> class Cylinder(rb.Rectifier[ScaleOptions]):
    ...     name = "cylinder"
    ...     def fit(self, problem: rb.Problem, options: ScaleOptions) -> rb.Rectification:
    ...         f = options.scale * rb.centre_resolution_px(problem.rig)
    ...         u, v = rb.Radial("cylindrical", f, 0.0), rb.Radial("equidistant", f, 0.0)
    ...         return rb.Rectification.from_profiles(problem.rig, u, u, v)
    >>> Cylinder.Options().scale
    1.0
    """

    name: ClassVar[str]
    references: ClassVar[tuple[str, ...]] = ()
    needs: ClassVar[frozenset[str]] = frozenset({"pose"})
    is_control: ClassVar[bool] = False
    Options: type[OptionsT] = Options  # type: ignore[assignment]  # the variable's default is Any

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        bases = vars(cls).get("__orig_bases__", ())
        in_brackets: list[Any] = [of for base in bases for of in get_args(base) if _is_options(of)]
        if in_brackets and "Options" not in vars(cls):
            cls.Options = in_brackets[0]

    @abstractmethod
    def fit(self, problem: Problem, options: OptionsT) -> Rectification:
        """The rectification of the rig; raises Unsupported, with the reason, where there is none."""


def _is_options(value: object) -> bool:
    return inspect.isclass(value) and issubclass(value, Options)


def _described(value: Any) -> Described[Rectifier] | None:
    described = described_object(value, Rectifier)
    if described and not _is_options(options := described.value.Options):
        kind = type(described.value).__name__
        raise InvalidInput(f"{kind}.Options is {options!r}; expected a subclass of Options")
    return described


METHODS: Kind[Rectifier] = Kind(
    name="methods",
    singular="method",
    expected="a subclass of rectbench.Rectifier with a name",
    packages=("rectbench_methods",),
    described=_described,
)


def is_built_in(plugin: Plugin[Rectifier]) -> bool:
    """Whether a method came with rectbench."""
    return type(plugin.value).__module__.startswith(METHODS.packages)
