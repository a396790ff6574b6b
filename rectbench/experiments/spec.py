"""What a report asks for: a grid of cells, how they are rendered, and what is measured."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping
from typing import Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, model_validator

from rectbench.experiments.claims import Claim
from rectbench.metrics.scoring import metrics_of, needs_of
from rectbench.registry.kind import Described, Kind

Figures = Literal["bars", "scatter", "pairs", "maps", "energy", "starts", "squares", "clouds", "timing"]
Names = Annotated[tuple[str, ...], Field(min_length=1)]
Slug = Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9-]*$")]
PairName = tuple[str, str, str]
"""Scene, rig, motion."""


def _one_set_is_a_list_of_one(options: Any) -> Any:
    if not isinstance(options, Mapping):
        return options
    return {name: (given,) if isinstance(given, Mapping) else given for name, given in options.items()}


OptionSets = Annotated[Mapping[str, tuple[dict[str, Any], ...]], BeforeValidator(_one_set_is_a_list_of_one)]

IMAGE_FIGURES = frozenset({"pairs", "clouds"})
ESTIMATED = "estimated"
"""The pose that is estimated from the images themselves."""
CALIBRATED = "calibrated"
"""The pose as a calibration states it, of which nobody knows how exact it is: that of photographs."""


class Group(BaseModel):
    """A part of a report with pairs and methods of its own, shown apart from the other parts."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: Slug | Literal[""] = Field(description="Name in the rows and in the names of figures.")
    title: str = Field(default="", description="Heading of the part.")
    pairs: tuple[PairName, ...] = Field(description="The pairs: (scene, rig, motion) each, by name or path.")
    methods: Names = Field(description="Rectifiers, by name or path.")
    options: OptionSets = Field(default_factory=dict, description="As a report's.")
    metrics: tuple[str, ...] | None = Field(default=None, description="In the place of the report's.")
    figures: tuple[Figures, ...] | None = Field(default=None, description="In the place of the report's.")
    seeds: Annotated[tuple[int, ...], Field(min_length=1)] | None = Field(
        default=None, description="In the place of the report's."
    )
    image_width: int | None = Field(default=None, ge=16, description="In the place of the report's.")
    is_open: bool = Field(default=True, description="Whether methods added to a run join this part.")
    alone: bool = Field(
        default=False,
        description="Whether its cells run one at a time on all cores, for times worth quoting.",
    )


class Report(BaseModel):
    """A report: every scene × rig × motion × pose × method × seed, each one row of its table.

    A file in `reports/` states one at its top level. Names may also be paths of plugin and rig
    files. In the place of one grid a report may have `groups`, each with its own pairs and methods;
    or it takes `photographs`, and its pairs are those of a folder that each run names. Raises
    pydantic's ValidationError for a field that cannot be used as given.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: Slug = Field(description="Name on the command line and of the folder.")
    title: str = Field(description="Heading of the page.")
    description: str = Field(default="", description="A paragraph under the heading.")
    scenes: tuple[str, ...] = Field(default=(), description="Scenes, by name or path.")
    rigs: tuple[str, ...] = Field(default=(), description="Rigs, by name or path.")
    motions: Names = Field(default=("as-calibrated",), description="How the right camera stands to the left.")
    methods: tuple[str, ...] = Field(default=(), description="Rectifiers, by name or path.")
    groups: tuple[Group, ...] = Field(default=(), description="Parts, in the place of one grid.")
    photographs: bool = Field(
        default=False,
        description="Whether the pairs are photographs, found in a folder that each run names; what is "
        "measured then needs no truth.",
    )
    pairs: tuple[PairName, ...] = Field(
        default=(), description="Pairs of (scene, rig, motion) in the place of scenes × rigs × motions."
    )
    poses: Names = Field(
        default=("exact",),
        description="How well the rectifiers know the relative pose: exact, perturbed, or estimated from "
        "the images. Of photographs: calibrated, or estimated.",
    )
    options: OptionSets = Field(
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
    metrics: tuple[str, ...] = Field(
        default=("geometry", "row_error", "timing"),
        description="What is measured: metrics, by name or path. `geometry` is all that needs neither image "
        "nor match. Nothing is rendered or computed that none of these asks for.",
    )
    match_count: int = Field(
        default=1000, ge=8, description="Matches given to the rectifiers that need them."
    )
    match_noise_px: float = Field(
        default=0.0, ge=0, description="Noise on those, standard deviation, pixels."
    )
    claims: tuple[Claim, ...] = Field(default=(), description="What is claimed somewhere, to be judged.")
    stated_seconds: Mapping[Literal["pose", "fit", "warp"], float] = Field(
        default_factory=dict, description="Times somebody else stated, to stand beside the measured ones."
    )
    timeout_s: float = Field(default=120.0, gt=0, description="After which a cell is stopped, seconds.")
    render_timeout_s: float = Field(default=1800.0, gt=0, description="The same for rendering one pair.")
    memory_gib: float = Field(default=4.0, gt=0, description="What one worker may allocate, GiB.")
    figures: tuple[Figures, ...] | None = Field(
        default=None, description="Figures to draw; None draws the usual ones."
    )

    @model_validator(mode="after")
    def _is_one_grid_or_groups(self) -> Report:
        grid: dict[str, Any] = {"scenes": self.scenes, "rigs": self.rigs, "methods": self.methods}
        if self.photographs:
            grid |= {"pairs": self.pairs, "groups": self.groups}
            stated = [name for name, values in grid.items() if values and name != "methods"]
            if stated:
                raise ValueError(f"{stated[0]} stand beside photographs; expected pairs found in a folder")
            if not self.methods:
                raise ValueError("methods are missing; expected at least one")
        elif self.groups:
            stated = [name for name, values in {**grid, "options": self.options}.items() if values]
            if stated:
                raise ValueError(f"{stated[0]} stand beside groups; expected them in the groups")
            names = [group.name for group in self.groups]
            if len(set(names)) < len(names) or "" in names:
                raise ValueError(f"groups are called {', '.join(map(repr, names))}; expected a name each")
            if empty := [group.name for group in self.groups if not group.pairs]:
                raise ValueError(f"group '{empty[0]}' has no pairs; expected at least one")
        elif self.pairs:
            if self.scenes or self.rigs or not self.methods:
                raise ValueError("expected methods beside pairs, and neither scenes nor rigs")
        else:
            missing = [name for name, values in grid.items() if not values]
            if missing:
                raise ValueError(f"{missing[0]} are missing; expected at least one, or groups")
        return self

    @model_validator(mode="after")
    def _photographs_have_no_truth(self) -> Report:
        if self.photographs:
            for plugin in metrics_of(self.metrics).values():
                if "truth" in plugin.value.needs:
                    raise ValueError(f"metric {plugin.name} needs the truth, which photographs have not")
            if foreign := [pose for pose in self.poses if pose not in (CALIBRATED, ESTIMATED)]:
                raise ValueError(f"pose of photographs is {foreign[0]}; expected {CALIBRATED} or {ESTIMATED}")
        return self

    @model_validator(mode="after")
    def _claims_speak_of_what_there_is(self) -> Report:
        methods = {part.name: part.methods for part in self.parts}
        for statement in (s for claim in self.claims for s in claim.statements):
            elsewhere = statement.group if statement.against_group is None else statement.against_group
            rivals = (*statement.rivals, *([] if statement.against is None else [statement.against]))
            spoken = [(statement.group, statement.method), *((elsewhere, rival) for rival in rivals)]
            for group, method in spoken:
                if group not in methods:
                    raise ValueError(
                        f"statement '{statement.label}' speaks of group '{group}', which is none"
                    )
                if method not in methods[group]:
                    where = f"group '{group}'" if group else "the report"
                    raise ValueError(f"statement '{statement.label}' speaks of {method}, which {where} lacks")
        return self

    @property
    def parts(self) -> tuple[Group, ...]:
        """The groups; the grid of a report without groups as one group without a name."""
        if self.groups:
            return self.groups
        pairs = self.pairs or tuple(itertools.product(self.scenes, self.rigs, self.motions))
        return (Group(name="", pairs=pairs, methods=self.methods, options=self.options),)

    @property
    def own_names(self) -> dict[str, tuple[str, ...]]:
        """The scenes, rigs and methods of all parts."""
        pairs = [pair for part in self.parts for pair in part.pairs]
        methods = (name for part in self.parts for name in part.methods)
        return {
            "scenes": _distinct(scene for scene, _, _ in pairs),
            "rigs": _distinct(rig for _, rig, _ in pairs),
            "methods": _distinct(methods),
        }

    @property
    def all_seeds(self) -> tuple[int, ...]:
        """The seeds of all parts."""
        return tuple(dict.fromkeys(seed for part in self.parts for seed in self.seeds_of(part)))

    def metrics_of(self, part: Group) -> tuple[str, ...]:
        """What is measured in a part."""
        return self.metrics if part.metrics is None else part.metrics

    def figures_of(self, part: Group) -> tuple[Figures, ...] | None:
        """The kinds of figures of a part; None draws the usual ones."""
        return self.figures if part.figures is None else part.figures

    def seeds_of(self, part: Group) -> tuple[int, ...]:
        """The repetitions of a part."""
        return self.seeds if part.seeds is None else part.seeds

    def image_width_of(self, part: Group) -> int | None:
        """Width to which the rigs of a part are scaled, pixels; None keeps their own."""
        return self.image_width if part.image_width is None else part.image_width

    def needs_images(self, part: Group) -> bool:
        """Whether anything in a part asks for rendered images rather than the truth alone."""
        figures = self.figures_of(part)
        return (
            ESTIMATED in self.poses
            or "images" in needs_of(self.metrics_of(part))
            or figures is None
            or not IMAGE_FIGURES.isdisjoint(figures)
        )

    def needs_truth(self, part: Group) -> bool:
        """Whether any metric of a part asks for the truth."""
        return "truth" in needs_of(self.metrics_of(part))


def _distinct(names: Iterable[str]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(names))


def _described(value: Any) -> Described[Report] | None:
    return Described(value.name, value.title, value) if isinstance(value, Report) else None


REPORTS: Kind[Report] = Kind(
    name="reports",
    singular="report",
    expected="a rectbench.Report",
    package="rectbench_reports",
    described=_described,
)
