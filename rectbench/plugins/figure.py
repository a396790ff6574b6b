"""What a figure of a report is: the drawings that it makes of a part of a run, and what it may ask for."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Set
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar, Literal, NamedTuple

from rectbench.errors import InvalidInput
from rectbench.registry import registry
from rectbench.registry.kind import Described, Kind, described_object

if TYPE_CHECKING:  # what needs nothing but a figure's name is to be quick
    import matplotlib.figure

    from rectbench.matching import Reconstruction
    from rectbench.plugins.metric import Known
    from rectbench.plugins.result import Part, Result
    from rectbench.rigs import Rig
    from rectbench.types import FloatArray
    from rectbench.warps import Rectification

Side = Literal["left", "right"]


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

    pair: Callable[[Result], Known]
    rectification: Callable[[Result], Rectification]
    distortion: Callable[[Rectification, Rig, Side, FloatArray], FloatArray]
    reconstruction: Callable[[Result], Reconstruction]
    version: Callable[[Result], str] = lambda result: ""


class Look(NamedTuple):
    """How a method is told from others, in matplotlib's words; the colour-blind tell the colours too."""

    colour: str
    marker: str
    hatch: str
    """Empty but for methods beyond the number of colours."""


@dataclass(frozen=True)
class FigureData:
    """All that a figure is made from.

    >>> def coloured(given: FigureData):  # each method in its colour, the same in all figures
    ...     return {method: given.looks[method].colour for method in given.part.methods}
    """

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

    >>> Drawing("tall", "Tallness", "Of every pair.", [1, 2], lambda: None).shown_as
    'svg'
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

    >>> class Histogram(Figure):
    ...     "Log distortion of all pairs."
    ...     name, topic = "histogram", "Charts"
    ...
    ...     def drawings(self, given):
    ...         import matplotlib.pyplot as plt
    ...
    ...         def draw():
    ...             figure, axes = plt.subplots()
    ...             axes.hist([r.metrics["log_distortion"] for r in given.part.results if r.ok])
    ...             return figure
    ...
    ...         yield Drawing("histogram", "Log distortion", "Of every pair.", given.part.results, draw)
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
    described = described_object(value, Figure, "topic")
    if described and (strange := sorted(described.value.needs - {"images"})):
        kind = type(described.value).__name__
        raise InvalidInput(f"{kind}.needs holds {strange[0]!r}; expected at most images")
    return described


FIGURES: Kind[Figure] = Kind(
    name="figures",
    singular="figure",
    expected="a subclass of rectbench.Figure with a name and a topic",
    packages=("rectbench.reporting.charts", "rectbench.reporting.pictures"),
    described=_described,
    is_shared=True,
)


def usual_figures(offered: Set[str] = frozenset({"images"})) -> tuple[str, ...]:
    """The names of the figures that are drawn where a report asks for none, in their order.

    Without those that need more of a pair than what is `offered`.
    """
    figures = [plugin.value for plugin in registry(FIGURES).plugins() if plugin.value.needs <= offered]
    usual = sorted((figure.usual, figure.name) for figure in figures if figure.usual is not None)
    return tuple(name for _, name in usual)
