"""What a report asks for: a grid of cells, how they are rendered, and what is measured."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, model_validator

from rectbench.experiments.claims import Claim, SourcePart
from rectbench.experiments.pair_sources import (
    Lenses,
    PairName,
    PairSource,
    Photographed,
    Rendered,
    Rendering,
    StatedPart,
)
from rectbench.margin import WIDEST_MARGIN_DEG
from rectbench.pairs.spec import CALIBRATED, ESTIMATED, NO_SCENE
from rectbench.plugins.matches import FROM_IMAGES, match_level
from rectbench.registry import is_path
from rectbench.registry.kind import Described, Kind

Names = Annotated[tuple[str, ...], Field(min_length=1)]
Slug = Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9-]*$")]


def _found_from_anywhere(name: str) -> str:
    return str(Path(name).resolve()) if is_path(name) else name


PluginName = Annotated[str, AfterValidator(_found_from_anywhere)]
"""A plugin's name, or the absolute path of its file."""


def _one_set_is_a_list_of_one(options: Any) -> Any:
    if not isinstance(options, Mapping):
        return options
    return {name: (given,) if isinstance(given, Mapping) else given for name, given in options.items()}


OptionSets = Annotated[Mapping[str, tuple[dict[str, Any], ...]], BeforeValidator(_one_set_is_a_list_of_one)]


MatchLevel = Annotated[str, AfterValidator(match_level)]
Seeds = Annotated[tuple[int, ...], Field(min_length=1)]


class StatedPairs(BaseModel):
    """Pairs, stated as a grid or one by one."""

    model_config = ConfigDict(use_attribute_docstrings=True)

    scenes: tuple[str, ...] = ()
    """Scenes, by name or path. Rigs without scenes are lenses alone: nothing is rendered, and what is
    measured needs neither images nor their truth, as `geometry` does not."""
    rigs: tuple[str, ...] = ()
    """Rigs, by name or path."""
    pairs: tuple[PairName, ...] = ()
    """Pairs of (scene, rig, motion) in the place of that grid; lenses alone have the scene "none"."""

    def pair_names(self, motions: tuple[str, ...]) -> tuple[PairName, ...]:
        """Its pairs, those of the grid under these motions."""
        return self.pairs or tuple(itertools.product(self.scenes or (NO_SCENE,), self.rigs, motions))


class Group(StatedPairs):
    """A part of a report with pairs and methods of its own, shown apart from the other parts.

    Its pairs are stated as a report's are: as a grid of `scenes`, `rigs` and `motions`, or as `pairs`. A
    grid without scenes is of lenses alone.

    >>> lenses = Group(name="lenses", rigs=("t265", "tumvi"), motions=("sideways",), methods=("abraham",))
    >>> lenses.pair_names(lenses.motions)
    (('none', 't265', 'sideways'), ('none', 'tumvi', 'sideways'))
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: Slug | Literal[""]
    """Name in the rows and in the names of figures."""
    title: str = ""
    """Heading of the part."""
    motions: Names | None = None
    """In the place of the report's."""
    methods: Names
    """Rectifiers, by name or path."""
    options: OptionSets = Field(default_factory=dict)
    """As a report's."""
    metrics: tuple[str, ...] | None = None
    """In the place of the report's."""
    figures: tuple[PluginName, ...] | None = None
    """In the place of the report's."""
    poses: Names | None = None
    """In the place of the report's."""
    matches: tuple[MatchLevel, ...] | None = Field(default=None, min_length=1)
    """In the place of the report's."""
    seeds: Seeds | None = None
    """In the place of the report's."""
    image_width: int | None = Field(default=None, ge=16)
    """In the place of the report's."""
    is_open: bool = True
    """Whether methods added to a run join this part."""
    alone: bool = False
    """Whether its cells run one at a time on all cores, for times worth quoting."""


class GivenMatches(BaseModel):
    """What rectifiers that work from matches are given."""

    model_config = ConfigDict(use_attribute_docstrings=True)

    matches: tuple[MatchLevel, ...] = Field(default=(FROM_IMAGES,), min_length=1)
    """Levels of matches, each a row of its own for the rectifiers that work from them: `images` for those
    found in the images; `true` for exact ones; `true + 0.1 px` for these with Gaussian noise of that standard
    deviation. Lenses alone have true ones, of points at 5 to 200 baselines, and photographs those of the
    images."""
    match_count: int = Field(default=1000, ge=8)
    """How many true ones."""

    @model_validator(mode="before")
    @classmethod
    def _states_noise_as_a_level(cls, given: Any) -> Any:
        if isinstance(given, Mapping) and "match_noise_px" in given:
            level = match_level(f"true + {given['match_noise_px']} px")
            raise ValueError(f"match_noise_px is no field of a report; expected matches=('{level}',) instead")
        return given


class CellLimits(BaseModel):
    """When a cell or a pair is given up."""

    model_config = ConfigDict(use_attribute_docstrings=True)

    timeout_s: float = Field(default=120.0, gt=0)
    """After which a cell is stopped, seconds."""
    render_timeout_s: float = Field(default=1800.0, gt=0)
    """The same for rendering one pair."""
    memory_gib: float = Field(default=4.0, gt=0)
    """What one worker may allocate, GiB."""


_STATING_PAIRS: Mapping[str, tuple[tuple[str, ...], tuple[str, ...], str]] = {
    "photographs": (("methods",), ("scenes", "rigs", "pairs", "groups"), "pairs found in a folder"),
    "groups": ((), ("scenes", "rigs", "methods", "options", "pairs"), "them in the groups"),
    "pairs": (("methods",), ("scenes", "rigs"), "them in the pairs"),
    "rigs": (("rigs", "methods"), (), ""),
}
"""By the field that states a report's pairs: the fields that must not be empty then, those that must be, and
what is expected in the place of these."""


class Report(StatedPairs, Rendering, GivenMatches, CellLimits):
    """A report: every scene × rig × motion × pose × method × seed, each one row of its table.

    A file in `reports/` states one at its top level. Names may also be paths of plugin and rig files. Its
    pairs are stated in one of four ways, see `sources`: as a grid of `scenes`, `rigs` and `motions`, which
    is of lenses alone where it has no scenes; as `pairs`, one by one; as `groups`, each with its own pairs
    and methods; or as `photographs`, to be found in a folder that each run names. Raises pydantic's
    ValidationError for a field that cannot be used as given.

    >>> report = Report(
    ...     name="mine",
    ...     title="Two methods in the street",
    ...     scenes=("street",),
    ...     rigs=("t265", "canon-8mm"),
    ...     motions=("sideways",),
    ...     methods=("abraham", "local-homography"),
    ...     metrics=("geometry",),
    ... )
    >>> report.parts[0].pairs
    (('street', 't265', 'sideways'), ('street', 'canon-8mm', 'sideways'))
    """

    name: Slug
    """Name on the command line and of the folder."""
    title: str
    """Heading of the page."""
    description: str = ""
    """A paragraph under the heading."""
    motions: Names = ("as-calibrated",)
    """How the right camera stands to the left."""
    groups: tuple[Group, ...] = ()
    """Parts, in the place of one grid."""
    photographs: bool = False
    """Whether the pairs are photographs, found in a folder that each run names; what is measured then
    needs no truth."""
    methods: tuple[str, ...] = ()
    """Rectifiers, by name or path."""
    options: OptionSets = Field(default_factory=dict)
    """Options of a rectifier by its name: one set, or a list of sets, each a row of its own."""
    poses: Names = ("exact",)
    """How well the rectifiers know the relative pose: exact, perturbed, or estimated from the images. Of
    photographs: calibrated, or estimated."""
    seeds: Seeds = (0,)
    """Repetitions; of lenses alone, of what a seed draws: perturbed poses and the noise of matches."""
    margin_deg: float | None = Field(default=None, gt=0, le=WIDEST_MARGIN_DEG)
    """How near to the epipoles views are trimmed before any method sees them; the usual margin by default."""
    max_angle_deg: Mapping[str, float] = Field(default_factory=dict)
    """Image circles of rigs by their names, in the place of their own; lenses show nothing beyond."""
    metrics: tuple[str, ...] = ("geometry", "row_error", "timing")
    """What is measured: metrics, by name or path. `geometry` is all that needs neither image nor match.
    Nothing is rendered or computed that none of these asks for."""
    matcher: PluginName = "sgbm"
    """What matches rectified pairs densely, by name or path, where a metric or a figure asks for that."""
    figures: tuple[PluginName, ...] | None = None
    """Figures to draw; None draws the usual ones."""
    claims: tuple[Claim, ...] = ()
    """What is claimed somewhere, to be judged."""
    source_parts: tuple[SourcePart, ...] = ()
    """What the source of these experiments has, part by part, and what became of it here."""
    stated_seconds: Mapping[Literal["pose", "fit", "warp"], float] = Field(default_factory=dict)
    """Times somebody else stated, to stand beside the measured ones."""

    @property
    def sources(self) -> tuple[PairSource, ...]:
        """Where the pairs of each of its parts come from."""
        return tuple(map(self._source, self.parts))

    def _source(self, part: StatedPart) -> PairSource:
        if self.photographs:
            return Photographed(part)
        return Lenses(part) if part.pairs[0][0] == NO_SCENE else Rendered(part)

    @property
    def parts(self) -> tuple[StatedPart, ...]:
        """The groups, with what they leave to the report; a report without groups as one without a name."""
        one = {"name": "", "methods": self.methods, "options": self.options}
        pairs = self.pair_names(self.motions)
        return tuple(map(self._part, self.groups or (Group.model_validate({**one, "pairs": pairs}),)))

    def _part(self, group: Group) -> StatedPart:
        metrics = self.metrics if group.metrics is None else group.metrics
        figures = self.figures if group.figures is None else group.figures
        width = self.image_width if group.image_width is None else group.image_width
        return StatedPart(
            name=group.name,
            title=group.title,
            pairs=group.pair_names(group.motions or self.motions),
            methods=group.methods,
            options=group.options,
            poses=group.poses or self.poses,
            matches=group.matches or self.matches,
            seeds=group.seeds or self.seeds,
            metrics=metrics,
            figures=figures,
            rendering=Rendering(image_width=width, quality=self.quality, spp=self.spp),
            is_open=group.is_open,
            alone=group.alone,
        )

    @model_validator(mode="after")
    def _states_its_pairs_in_one_way(self) -> Report:
        stated_by = next((name for name in _STATING_PAIRS if getattr(self, name)), "rigs")
        needs, excludes, instead = _STATING_PAIRS[stated_by]
        if beside := [name for name in excludes if getattr(self, name)]:
            raise ValueError(f"{beside[0]} stand beside {stated_by}; expected {instead}")
        if missing := [name for name in needs if not getattr(self, name)]:
            raise ValueError(f"{missing[0]} are missing; expected at least one, or groups")
        names = [group.name for group in self.groups]
        if len(set(names)) < len(names) or "" in names:
            raise ValueError(f"groups are called {', '.join(map(repr, names))}; expected a name each")
        for group in self.groups:
            _check_pairs(group)
        for part in self.parts:
            if len({scene == NO_SCENE for scene, _, _ in part.pairs}) > 1:
                raise ValueError("pairs with and without a scene stand together; expected a group of each")
        return self

    @model_validator(mode="after")
    def _has_levels_that_can_be(self) -> Report:
        if not self.photographs:
            return self
        if foreign := [pose for pose in self.poses if pose not in (CALIBRATED, ESTIMATED)]:
            raise ValueError(f"pose of photographs is {foreign[0]}; expected {CALIBRATED} or {ESTIMATED}")
        if foreign := [level for level in self.matches if level != FROM_IMAGES]:
            raise ValueError(f"matches of photographs are {foreign[0]}; expected {FROM_IMAGES}")
        return self

    @model_validator(mode="after")
    def _claims_speak_of_what_there_is(self) -> Report:
        methods = {part.name: part.methods for part in self.parts}
        for statement in (s for claim in self.claims for s in claim.statements):
            for group, method in statement.speaks_of:
                if group not in methods:
                    raise ValueError(
                        f"statement '{statement.label}' speaks of group '{group}', which is none"
                    )
                if method not in methods[group]:
                    where = f"group '{group}'" if group else "the report"
                    raise ValueError(f"statement '{statement.label}' speaks of {method}, which {where} lacks")
        return self


def _check_pairs(group: Group) -> None:
    """Raise ValueError for a group that states its pairs in no way, or in two."""
    if not (group.pairs or group.rigs):
        raise ValueError(f"group '{group.name}' has no pairs; expected at least one")
    if beside := [name for name in ("scenes", "rigs", "motions") if group.pairs and getattr(group, name)]:
        raise ValueError(
            f"{beside[0]} stand beside the pairs of group '{group.name}'; expected them in these"
        )


def _described(value: Any) -> Described[Report] | None:
    return Described(value.name, value.title, value) if isinstance(value, Report) else None


REPORTS: Kind[Report] = Kind(
    name="reports",
    singular="report",
    expected="a rectbench.Report",
    packages=("rectbench_reports",),
    described=_described,
)
