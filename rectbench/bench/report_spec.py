"""What a report asks for: a grid of cells, how they are rendered, and what is measured."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, field_validator

Metric = Literal["geometry", "row_error", "row_error_features", "timing"]
"""Distortion, coverage and order; row error of the truth, and of SIFT matches in the images; times."""
Figures = Literal["bars", "scatter", "pairs", "maps"]
Names = Annotated[tuple[str, ...], Field(min_length=1)]


class Report(BaseModel):
    """A report: every scene × rig × motion × pose × method × seed, each one row of its table.

    A file in `reports/` states one at its top level. Names may also be paths of plugin and rig
    files. Raises pydantic's ValidationError for a field that cannot be used as given.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: str = Field(
        pattern=r"^[a-z0-9][a-z0-9-]*$", description="Name on the command line and of the folder."
    )
    title: str = Field(description="Heading of the page.")
    description: str = Field(default="", description="A paragraph under the heading.")
    scenes: Names = Field(description="Scenes, by name or path.")
    rigs: Names = Field(description="Rigs, by name or path.")
    motions: Names = Field(default=("as-calibrated",), description="How the right camera stands to the left.")
    poses: Names = Field(default=("exact",), description="How well the rectifiers know the relative pose.")
    methods: Names = Field(description="Rectifiers, by name or path.")
    options: Mapping[str, tuple[dict[str, Any], ...]] = Field(
        default_factory=dict,
        description="Options of a rectifier by its name: one set, or a list of sets, each a row of its own.",
    )
    seeds: Annotated[tuple[int, ...], Field(min_length=1)] = Field(default=(0,), description="Repetitions.")
    image_width: int | None = Field(
        default=None, ge=16, description="Width to which rigs are scaled, pixels; None keeps their own."
    )
    quality: Literal["path", "fast"] = Field(
        default="path", description="Path tracing, or the fast integrator."
    )
    spp: int = Field(default=64, ge=1, description="Samples a pixel.")
    metrics: tuple[Metric, ...] = Field(
        default=("geometry", "row_error", "timing"),
        description="What is measured. Nothing is rendered or computed that none of these asks for.",
    )
    match_count: int = Field(
        default=1000, ge=8, description="Matches given to the rectifiers that need them."
    )
    match_noise_px: float = Field(
        default=0.0, ge=0, description="Noise on those, standard deviation, pixels."
    )
    timeout_s: float = Field(default=120.0, gt=0, description="After which a cell is stopped, seconds.")
    render_timeout_s: float = Field(default=1800.0, gt=0, description="The same for rendering one pair.")
    memory_gib: float = Field(default=4.0, gt=0, description="What one worker may allocate, GiB.")
    figures: tuple[Figures, ...] | None = Field(default=None, description="Figures to draw; None draws all.")

    @field_validator("options", mode="before")
    @classmethod
    def _one_set_is_a_list_of_one(cls, options: Any) -> Any:
        if not isinstance(options, Mapping):
            return options
        return {name: (given,) if isinstance(given, Mapping) else given for name, given in options.items()}

    @property
    def needs_images(self) -> bool:
        """Whether anything asks for rendered images rather than the truth alone."""
        return "row_error_features" in self.metrics or self.figures is None or "pairs" in self.figures
