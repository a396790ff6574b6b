"""What a figure of a report is: the drawings that it makes of a part of a run, and what it may ask for."""

from __future__ import annotations

import inspect
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar, Literal, NamedTuple, Protocol

from rectbench.errors import InvalidInput
from rectbench.registry import registry
from rectbench.registry.kind import Described, Kind

if TYPE_CHECKING:  # what needs nothing but a figure's name is to be quick
    import matplotlib.figure
    import numpy as np
    from numpy.typing import NDArray

    from rectbench.images.stereo_pair import StereoPair
    from rectbench.plugins.metric import Column
    from rectbench.rendering.truth import Truth
    from rectbench.rigs import Rig
    from rectbench.types import FloatArray, Matches
    from rectbench.warps import Rectification

Side = Literal["left", "right"]


class Result(Protocol):
    """A cell of a run: one method on one pair, and what was measured.

    method : what it is called: its name, with its options where several sets of them ran.
    pair : the images it is about, as scene, rig, motion and seed; `place` is that without the seed.
    ok : whether it holds a measurement; otherwise `status` and `reason` say how it ended.
    metrics : the numbers by column, in the columns' units; what was not measured is left out.
    cell : which cell it is, with `method` and `options` as they are stored.
    """

    @property
    def scene(self) -> str: ...
    @property
    def rig(self) -> str: ...
    @property
    def motion(self) -> str: ...
    @property
    def pose(self) -> str: ...
    @property
    def seed(self) -> int: ...
    @property
    def method(self) -> str: ...
    @property
    def options(self) -> Mapping[str, Any]: ...
    @property
    def pair(self) -> tuple[str, str, str, int]: ...
    @property
    def place(self) -> tuple[str, str, str]: ...
    @property
    def ok(self) -> bool: ...
    @property
    def status(self) -> str: ...
    @property
    def reason(self) -> str: ...
    @property
    def metrics(self) -> Mapping[str, float]: ...
    @property
    def cell(self) -> Any: ...


class Columns(Protocol):
    """What is known of the columns of a run.

    column : one of them, by its key.
    panels : the columns of a topic that stand side by side in a figure: by key, the words above the panel.
    ranking : the one that methods are ranked by.
    """

    def column(self, key: str) -> Column: ...
    def panels(self, topic: str) -> Mapping[str, str]: ...
    @property
    def ranking(self) -> Column: ...


class Part(Protocol):
    """The results of a part of a report, or of all of it; names are in the run's order, each once.

    group : the part's name; empty of a report without parts.
    catalogue : what is known of its columns.
    stated_seconds : times that somebody else stated, by stage: `pose`, `fit`, `warp`.
    failures : the results without a measurement.
    metrics : the columns in which any cell has a number.
    noisy_poses : those whose row errors say something: all but the exact one, or this if there is no other.
    geometric_pose : the one under which distortion is shown: the exact one if there is one.
    has_truth : whether anybody knows the truth about its pairs, as nobody does about photographs.
    select : of all results, or of the given ones, those whose attributes equal what is wanted:
        `select(rig="t265", pose="exact")`.
    """

    @property
    def group(self) -> str: ...
    @property
    def catalogue(self) -> Columns: ...
    @property
    def stated_seconds(self) -> Mapping[str, float]: ...
    @property
    def results(self) -> tuple[Result, ...]: ...
    @property
    def failures(self) -> tuple[Result, ...]: ...
    @property
    def methods(self) -> tuple[str, ...]: ...
    @property
    def scenes(self) -> tuple[str, ...]: ...
    @property
    def rigs(self) -> tuple[str, ...]: ...
    @property
    def motions(self) -> tuple[str, ...]: ...
    @property
    def metrics(self) -> tuple[str, ...]: ...
    @property
    def noisy_poses(self) -> tuple[str, ...]: ...
    @property
    def geometric_pose(self) -> str: ...
    @property
    def has_truth(self) -> bool: ...
    def select(self, results: Sequence[Any] | None = None, **wanted: Any) -> tuple[Any, ...]: ...


class ShownPair(Protocol):
    """The images of a cell, and what is known of them.

    rig : the true one; of photographs the calibrated one.
    knows_truth : whether there is a `truth`; photographs have none, and raise InvalidInput.
    shown_matches : pixels [N, 2] each that correspond: true ones, or of photographs those found in them.
    """

    @property
    def images(self) -> StereoPair: ...
    @property
    def rig(self) -> Rig: ...
    @property
    def knows_truth(self) -> bool: ...
    @property
    def truth(self) -> Truth: ...
    def shown_matches(self) -> Matches: ...


class Cloud(Protocol):
    """Points [H, W, 3] in the left camera's frame, metres, NaN where there is none; colours [H, W, 3] RGB."""

    @property
    def points(self) -> FloatArray: ...
    @property
    def colours(self) -> NDArray[np.uint8]: ...


@dataclass(frozen=True)
class Sources:
    """What pictures are made from, found when it is asked for; each may raise any RectbenchError.

    Parameters
    ----------
    pair : the images of a cell and what is known of them.
    rectification : the cell's rectification, fitted again.
    distortion : native distortion [N] of a rectification at pixels [N, 2] of one side of a rig.
    reconstruction : the points that dense matching on the cell's rectified pair gives.
    version : changes with whatever changes those answers while the cell's row stays the same.
    """

    pair: Callable[[Result], ShownPair]
    rectification: Callable[[Result], Rectification]
    distortion: Callable[[Rectification, Rig, Side, FloatArray], FloatArray]
    reconstruction: Callable[[Result], Cloud]
    version: Callable[[Result], str] = lambda result: ""


class Look(NamedTuple):
    """How a method is told from others, in matplotlib's words; the colour-blind tell the colours too."""

    colour: str
    marker: str
    hatch: str
    """Empty but for methods beyond the number of colours."""


@dataclass(frozen=True)
class FigureData:
    """All that a figure is made from."""

    part: Part
    """The results to show; those that another figure sets apart are not among them."""
    run: Part
    """All results of the run, of all parts."""
    sources: Sources
    looks: Mapping[str, Look]
    """By method; the same in all figures of a run."""


@dataclass(frozen=True)
class Drawing:
    """One picture of a figure: its words, what it shows, and how it is drawn.

    Parameters
    ----------
    stem : what its files are called; the name of the part and `of` follow, where there are any.
    title, caption : as the page shows them.
    made_from : all data that it shows, as JSON or anything with a faithful `repr`: it is drawn again only
        where this or the figure's code has changed.
    draw : makes the picture; matplotlib has rectbench's style then.
    of : the rig, pose or whatever else that tells it from the figure's other drawings.
    dpi : resolution of the PNG, and of images within the other files.
    shown_as : which file the page shows; PNG is better where there are images in it.
    """

    stem: str
    title: str
    caption: str
    made_from: Any = field(repr=False)
    draw: Callable[[], matplotlib.figure.Figure] = field(repr=False)
    of: str = ""
    dpi: int = 160
    shown_as: Literal["svg", "png"] = "svg"


class Figure(ABC):
    """A figure of a report: one file, one class.

    The class's docstring says in its first line what it shows.
    """

    name: ClassVar[str]
    """What reports ask for."""
    topic: ClassVar[str]
    """The heading of the page that it stands under."""
    needs: ClassVar[frozenset[Literal["images"]]] = frozenset()
    """Whether it shows images; nothing is rendered that no metric, method or figure needs."""
    usual: ClassVar[int | None] = None
    """Its place among those drawn where a report asks for none; None to be drawn only if asked for."""

    @abstractmethod
    def drawings(self, given: FigureData) -> Iterable[Drawing]:
        """Its pictures of a part of a run; none where the part has no data for it.

        What it raises is told on the page in its place, and costs no other figure.
        """

    def sets_apart(self, result: Result) -> bool:
        """Whether a result is there for this figure alone: one of many starts, no method to compare."""
        return False


def _described(value: Any) -> Described[Figure] | None:
    """A figure, or the only instance of a class of them."""
    if inspect.isclass(value) and issubclass(value, Figure):
        if inspect.isabstract(value):
            return None
        value = value()
    if not isinstance(value, Figure):
        return None
    for attribute in ("name", "topic"):
        if not isinstance(found := getattr(value, attribute, None), str) or not found:
            raise InvalidInput(f"{type(value).__name__}.{attribute} is {found!r}; expected a text")
    if strange := sorted(value.needs - {"images"}):
        raise InvalidInput(f"{type(value).__name__}.needs holds {strange[0]!r}; expected at most images")
    return Described(value.name, (inspect.getdoc(type(value)) or "").partition("\n")[0], value)


FIGURES: Kind[Figure] = Kind(
    name="figures",
    singular="figure",
    expected="a subclass of rectbench.Figure with a name and a topic",
    packages=("rectbench.reporting.charts", "rectbench.reporting.pictures"),
    described=_described,
    is_shared=True,
)


def usual_figures() -> tuple[str, ...]:
    """The names of the figures that are drawn where a report asks for none, in their order."""
    places = {plugin.name: plugin.value.usual for plugin in registry(FIGURES).plugins()}
    usual = sorted((place, name) for name, place in places.items() if place is not None)
    return tuple(name for _, name in usual)
