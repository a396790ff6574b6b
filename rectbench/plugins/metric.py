"""What a metric is: columns of a row with all that is known of them, and how they are computed."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Set
from dataclasses import asdict, dataclass, field
from typing import Any, ClassVar, Literal, Protocol, TypeVar, get_args

from pydantic import ConfigDict, TypeAdapter, ValidationError

from rectbench.errors import InvalidInput
from rectbench.images.stereo_pair import StereoPair
from rectbench.matching import USUAL_MATCHER, BoardMatches, PoseEstimate
from rectbench.plugins.cell import IDENTITY
from rectbench.registry.kind import Described, Kind, described_object
from rectbench.rendering.truth import Truth
from rectbench.rigs import Rig
from rectbench.scored import Delivered, ScoredView, SeenView
from rectbench.types import Matches
from rectbench.warps import Rectification

Better = Literal["lower", "higher"]
Average = Literal["mean", "geometric", "rms", "max", "min"]
Need = Literal["truth", "images", "true_matches"]
Shown = Literal["rows", "pairs", "topic", "page", "summary"]

T = TypeVar("T")

RESERVED = {*IDENTITY, "status", "reason", "group", "notes"}
"""Columns that every row has; a metric's have other keys."""

TOPICS = (
    "Distortion",
    "Row error",
    "Coverage",
    "Sampling",
    "Order",
    "Poses",
    "Reconstruction",
    "Energy",
    "Time",
)
"""What metrics are about, in the order in which tables and the page show them; others follow these."""


@dataclass(frozen=True)
class Tolerance:
    """How far a column may be worse than accepted: by `relative` of the accepted value, plus `absolute`.

    >>> column = Column("a_px", "a", "px", "lower", tolerance=Tolerance(relative=0.01, absolute=1e-6))
    >>> column.change(accepted=100.0, now=100.9), column.change(accepted=100.0, now=101.1)
    ('same', 'worse')
    """

    relative: float
    absolute: float


@dataclass(frozen=True)
class Column:
    """One number of a row, and all that is known of it.

    Parameters
    ----------
    key : its name in `results.parquet`, the unit at its end.
    heading, unit : what stands above it; the shown number is the stored one times `scale`.
    better : which way is good, None where neither is.
    meaning : one sentence for the glossary.
    average : how cells are averaged. What has no upper bound is averaged by its logarithm ("geometric"), or
        one cell would be all that is seen; RMS values are pooled as such, a maximum stays one.
    floor : shown numbers below this are shown as "<floor".
    is_count : whether the number counts things, and is shown whole.
    tolerance : how far it may be worse than accepted before a gate closes; None where no gate looks at it.
    shown : where it first appears: in the rows alone, also in the table of each pair, also in its topic's
        table, also in the main table on the page, or in the main table on a terminal too.
    without_truth : whether the main tables show it only where nobody knows the truth, as of photographs.
    promised : whether the rows have the column even where it was not asked for, empty then.
    ranks : whether methods are ranked by it; one column of all metrics is.
    panel : what stands above its panel in a chart of its topic; without, it has none.

    >>> Column.share("kept", "kept", "higher", "Share that is kept.").full_heading
    'kept [%]'
    """

    key: str
    heading: str
    unit: str = ""
    better: Better | None = None
    meaning: str = ""
    scale: float = 1.0
    average: Average = "mean"
    floor: float = 0.0
    is_count: bool = False
    tolerance: Tolerance | None = None
    shown: Shown = "topic"
    without_truth: bool = False
    promised: bool = False
    ranks: bool = False
    panel: str = ""
    __pydantic_config__ = ConfigDict(allow_inf_nan=False)  # as run.json reads it back

    def __post_init__(self) -> None:
        """Raises InvalidInput for a tolerance about a number of which neither way is worse."""
        if self.tolerance and self.better is None:
            raise InvalidInput(f"column '{self.key}' has a tolerance; expected `better` beside it")

    @classmethod
    def pixels(cls, key: str, heading: str, meaning: str, **more: Any) -> Column:
        """A distance in pixels, better the smaller it is; what is below 10⁻⁶ is rounding."""
        return cls(key, heading, "px", "lower", meaning, floor=1e-6, **more)

    @classmethod
    def share(cls, key: str, heading: str, better: Better | None, meaning: str, **more: Any) -> Column:
        """A share, stored from 0 to 1 and shown in percent."""
        return cls(key, heading, "%", better, meaning, scale=100.0, **more)

    @classmethod
    def count(cls, key: str, heading: str, meaning: str, **more: Any) -> Column:
        """A number of things."""
        return cls(key, heading, meaning=meaning, is_count=True, **more)

    @property
    def is_percentage(self) -> bool:
        """Whether the number is a share, shown with one decimal."""
        return self.unit == "%"

    @property
    def full_heading(self) -> str:
        """Heading with the unit in brackets."""
        return f"{self.heading} [{self.unit}]" if self.unit else self.heading

    def change(self, accepted: float, now: float, slack: float = 1.0) -> Literal["same", "better", "worse"]:
        """How `now` stands to the accepted value, within `slack` times the tolerance.

        A number that is no longer there is worse.
        """
        if math.isnan(accepted) or math.isnan(now):
            if math.isnan(accepted) and math.isnan(now):
                return "same"
            return "worse" if math.isnan(now) else "better"
        if accepted == now:
            return "same"  # infinities too
        allowed = self.tolerance or Tolerance(0.0, 0.0)
        bound = slack * (allowed.relative * abs(accepted) + allowed.absolute)
        if math.isfinite(accepted) and abs(now - accepted) <= bound:
            return "same"
        return "better" if (now < accepted) == (self.better == "lower") else "worse"


class Known(Protocol):
    """What is known of the two images under a cell; each is found when it is first asked for."""

    @property
    def rig(self) -> Rig:
        """The true rig; of photographs the calibrated one."""

    @property
    def scored_view(self) -> ScoredView:
        """The view that rectifications are scored on, the same for all methods."""

    @property
    def seen_view(self) -> SeenView:
        """What the rig's lenses see, of which coverage is a share."""

    @property
    def images(self) -> StereoPair:
        """The images, rendered or photographed."""

    @property
    def knows_truth(self) -> bool:
        """Whether anybody knows the truth about the pair."""

    @property
    def truth(self) -> Truth:
        """The truth about a rendered pair. Raises InvalidInput for photographs, whose truth nobody knows."""

    @property
    def true_matches(self) -> Matches:
        """10,000 exact correspondences, unoccluded in both images; of lenses alone, of points at 5 to 200
        baselines all over the view. Raises InvalidInput for photographs."""

    @property
    def board(self) -> BoardMatches | None:
        """The corners of a calibration board that both images show; None where they show none."""

    @property
    def estimate(self) -> PoseEstimate:
        """The relative pose as the images tell it. Raises PoseNotFound where they tell none."""

    def features(self, *, by_estimate: bool) -> Matches:
        """SIFT matches of the images, freed of wrong ones by the true pose, or by the estimated one.

        Raises PoseNotFound where photographs tell no pose.
        """

    def shown_matches(self) -> Matches:
        """Correspondences that pictures choose from, the most certain ones that are known."""

    def pose_seconds(self) -> float:
        """Seconds from the two images, in memory, to their pose, warm."""


@dataclass(frozen=True, eq=False)
class Case:
    """A rectification to be scored, and what is known of the pair it belongs to.

    >>> def compute(case: Case):  # of a metric
    ...     return {"width_px": float(case.rect.size[0]), "baseline_m": case.rig.baseline_m}
    """

    rect: Rectification
    """What the method made of the rig that it believed in."""
    pair: Known
    believed: Rig | None = None
    """The rig that the method was told, where that is not the true one."""
    works_from: frozenset[str] = frozenset({"pose"})
    """What the method works from, its `needs`."""
    pose_is_estimated: bool = False
    """Whether the method was told the pose that the images tell."""
    fit: Callable[[], Rectification] | None = None
    """Fits the method once more; for times."""
    first_fit_s: float = math.nan
    """Seconds of the fit that gave `rect`."""
    matcher: str = USUAL_MATCHER
    """What dense matching is done by: a matcher's name, or the path of its file."""
    remarks: dict[str, str] = field(default_factory=dict)
    """What is to be said beside the numbers, by a name; metrics add theirs."""
    _made: dict[Callable[[Case], Any], Any] = field(default_factory=dict, init=False, repr=False)

    @property
    def rig(self) -> Rig:
        """The true rig; of photographs the calibrated one."""
        return self.pair.rig

    @property
    def delivered(self) -> Delivered:
        """What the lookup tables do to the view of the rig: what distortion is made of."""
        return self.once(_delivered)

    def once(self, compute: Callable[[Case], T]) -> T:
        """`compute` of this case, done once however many metrics ask for it."""
        if compute not in self._made:
            self._made[compute] = compute(self)
        made: T = self._made[compute]
        return made


def _delivered(case: Case) -> Delivered:
    return Delivered.of(case.rect, case.pair.scored_view)


class Metric(ABC):
    """A metric: one file, one class. Tables, gate, page and glossary take all they show from its columns.

    The class's docstring says in its first line what is measured.

    >>> class Tallness(Metric):
    ...     "How tall the output is."
    ...     name, topic = "tallness", "Sampling"
    ...     columns = (Column.pixels("tallness_px", "tallness", "Height of the rectified images."),)
    ...
    ...     def compute(self, case):
    ...         return {"tallness_px": float(case.rect.size[1])}
    """

    name: ClassVar[str]
    """What reports ask for."""
    topic: ClassVar[str]
    """The heading under which it is shown, see `TOPICS`."""
    needs: ClassVar[frozenset[Need]] = frozenset()
    """What of the pair it looks at beside the geometry: `true_matches`, which lenses alone have too; `truth`
    (these matches included); or `images` (with what is found in them). Nothing is rendered that no metric
    needs, and nothing else is handed out."""
    fits: ClassVar[tuple[str, ...]] = ()
    """Methods that it fits itself, to compare with: their sources shape its numbers too."""
    columns: ClassVar[tuple[Column, ...]]

    @abstractmethod
    def compute(self, case: Case) -> Mapping[str, float]:
        """The numbers of a row, by the keys of `columns`; one left out is empty there."""


def _described(value: Any) -> Described[Metric] | None:
    described = described_object(value, Metric, "topic")
    if described:
        kind, columns = type(described.value).__name__, getattr(described.value, "columns", None)
        if not isinstance(columns, tuple) or not columns:
            raise InvalidInput(f"{kind}.columns is {columns!r}; expected a tuple")
        for column in columns:
            _check_column(column, kind)
        keys = [column.key for column in columns]
        if twice := [key for key in keys if keys.count(key) > 1]:
            raise InvalidInput(f"{kind}.columns has '{twice[0]}' twice; expected a key of its own for each")
        needs = described.value.needs
        if not isinstance(needs, Set) or not needs <= set(get_args(Need)):
            raise InvalidInput(f"{kind}.needs is {needs!r}; expected a set of {' or '.join(get_args(Need))}")
    return described


def _check_column(column: Any, kind: str) -> None:
    """Raise InvalidInput for what run.json could not hold, or the rows have already."""
    if not (isinstance(column, Column) and isinstance(column.key, str) and column.key.isidentifier()):
        raise InvalidInput(f"{kind}.columns has {column!r}; expected a Column with a key")
    if column.key in RESERVED:
        raise InvalidInput(f"{kind}.columns has '{column.key}', which every row has; expected another key")
    try:
        TypeAdapter(Column).validate_python(asdict(column))
    except ValidationError as error:
        fault = error.errors(include_url=False)[0]
        name, value = ".".join(map(str, fault["loc"])), fault["input"]
        raise InvalidInput(f"column '{column.key}': {name} is {value!r}; {fault['msg']}") from None


METRICS: Kind[Metric] = Kind(
    name="metrics",
    singular="metric",
    expected="a subclass of rectbench.Metric with a name, a topic and columns",
    packages=("rectbench.metrics",),
    described=_described,
    is_shared=True,
)
