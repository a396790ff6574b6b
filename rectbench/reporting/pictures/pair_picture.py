"""A picture of one pair: what the figures have in common that show one for each rig."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, ClassVar, Literal

from rectbench.plugins.figure import Drawing, Figure, FigureData
from rectbench.plugins.result import Part, Result

if TYPE_CHECKING:
    import matplotlib.figure


class PairPicture(Figure):
    """A figure that is drawn once a rig, of the first of its pairs that was measured at all."""

    stem: ClassVar[str]
    title: ClassVar[str]
    caption: ClassVar[str]
    caption_of_photographs: ClassVar[str] = ""
    """Where the pair is photographs, if it is another one."""
    dpi: ClassVar[int] = 160
    shown_as: ClassVar[Literal["svg", "png"]] = "png"

    @abstractmethod
    def draw(self, results: Sequence[Result], given: FigureData) -> matplotlib.figure.Figure:
        """The picture of what all methods made of one pair, a result each."""

    def drawings(self, given: FigureData) -> Iterator[Drawing]:
        """One a rig."""
        part = given.part
        for rig in part.rigs:
            results = _shown_results(part, rig)
            if results:
                shown = results[0]
                yield Drawing(
                    self.stem,
                    f"{self.title}, {rig}",
                    f"{_pair_words(part, shown)}, {shown.pose} pose. {self._caption(part)}",
                    [list(results), given.sources.version(shown)],
                    lambda results=results: self.draw(results, given),  # type: ignore[misc]
                    of=rig,
                    dpi=self.dpi,
                    shown_as=self.shown_as,
                )

    def _caption(self, part: Part) -> str:
        return (not part.has_truth and self.caption_of_photographs) or self.caption


def _pair_words(part: Part, shown: Result) -> str:
    """What the picture's pair is called."""
    if not part.has_truth:
        return f"Pair {shown.scene}, rig {shown.rig}"
    return f"Scene {shown.scene}, rig {shown.rig}, {shown.motion}"


def _shown_results(part: Part, rig: str) -> tuple[Result, ...]:
    """The results of the first pair of a rig that any method was measured on."""
    candidates = part.select(rig=rig, pose=part.noisy_poses[0])
    for pair in dict.fromkeys(r.pair for r in candidates):
        results = part.select(candidates, pair=pair)
        if any(r.ok for r in results):
            return results
    return ()
