"""The figures of a run: which drawings there are, and which of them changed."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from rectbench.errors import InvalidInput, InvalidResult
from rectbench.plugins.figure import Drawing, Figure, FigureData, Sources
from rectbench.progress import Advance
from rectbench.registry import Plugin
from rectbench.reporting.asked import wanted_figures, without_set_apart
from rectbench.reporting.names import named, slug
from rectbench.reporting.style import PAGE_INCHES, STYLE, encode, looks
from rectbench.runs.run import Run
from rectbench.store.keys import code_digest, digest, file_digest, versions
from rectbench.writing import write_atomically

if TYPE_CHECKING:
    import matplotlib.figure

EXTENSIONS = ("pdf", "svg", "png")
OTHER_TOPIC = "Charts"
"""Where a figure stands that cannot be loaded, and so has no topic."""


@dataclass(frozen=True)
class PlacedDrawing:
    """A drawing and its place in the report."""

    drawing: Drawing
    name: str
    """What its files are called."""
    part: str
    """The part of the report that it belongs to, and the heading that it stands under there."""
    topic: str
    made_by: str
    """Digest of the code that makes the figure, and of the looks of the methods in it."""

    @property
    def digest(self) -> str:
        """Changes with whatever changes the picture."""
        made_from = json.dumps(self.drawing.made_from, default=repr, sort_keys=True)
        # What answers for pictures is no part of the figure's own code.
        shared = code_digest("rectbench.reporting.figures", "rectbench.reporting.sources")
        drawn_with = [versions("matplotlib")["matplotlib"], file_digest(STYLE)]
        return digest([self.name, self.drawing.dpi, made_from, self.made_by, shared, drawn_with])

    def path(self, extension: str) -> str:
        """Where the picture lies in the run's folder."""
        return f"figures/{self.name}.{extension}"


def placed_drawings(run: Run, sources: Sources) -> list[PlacedDrawing]:
    """The drawings of each part of the run that it asks for and has data for."""
    return [placed for part in run.parts for placed in _drawings_of(part, run, sources)]


def _drawings_of(part: Run, run: Run, sources: Sources) -> Iterator[PlacedDrawing]:
    """A part's drawings; those of one rig stand together, so that its pair is found once for them."""
    wanted, styles = wanted_figures(part), looks(run.methods)
    loaded = [plugin.value for plugin in wanted.values() if isinstance(plugin, Plugin)]
    placed: dict[str, PlacedDrawing] = {}
    for asked, plugin in wanted.items():
        topic, made_by = OTHER_TOPIC, ""
        if isinstance(plugin, Plugin):
            topic = plugin.value.topic
            made_by = digest([plugin.digest, {method: styles[method] for method in part.methods}])
            shown = without_set_apart(part, (figure for figure in loaded if figure is not plugin.value))
            drawings = _drawings(plugin, FigureData(shown, run, sources, styles)) if shown else []
        else:
            drawings = [_failed(asked, plugin)]
        for drawing in drawings:
            name = named(part, drawing.stem, drawing.of)
            if name in placed:
                drawing = _failed(f"{asked} {name}", InvalidInput(f"two drawings are called {name}"))
                name = named(part, drawing.stem)
            placed[name] = PlacedDrawing(drawing, name, part.group, topic, made_by)
    rigs = ("", *part.rigs)
    yield from sorted(
        placed.values(), key=lambda one: rigs.index(one.drawing.of if one.drawing.of in rigs else "")
    )


def _drawings(plugin: Plugin[Figure], given: FigureData) -> list[Drawing]:
    """The figure's drawings, or one that tells what it raised instead: a plugin may raise anything."""
    try:
        drawings = list(plugin.value.drawings(given))
        if strange := [one for one in drawings if not isinstance(one, Drawing)]:
            raise InvalidResult(f"{plugin.name} yields a {type(strange[0]).__name__}; expected Drawings")
    except Exception as error:
        return [_failed(plugin.name, error)]
    return drawings


def _failed(title: str, error: Exception) -> Drawing:
    def draw() -> matplotlib.figure.Figure:
        raise error

    return Drawing(slug(title), title, "", str(error), draw)


@dataclass(frozen=True)
class Drawn:
    """A figure on the page: drawn, or not and why, or left there by an earlier report of the folder."""

    placed: PlacedDrawing
    error: str = ""
    there: bool = True
    width_inches: float = PAGE_INCHES


Draw = Callable[[Sequence[PlacedDrawing]], Iterator[tuple[PlacedDrawing, str]]]
"""Draws into a run's folder; gives each drawing as it is done, with what went wrong or nothing."""


def draw_changed(
    folder: Path, drawings: Sequence[PlacedDrawing], known: Mapping[str, str], draw: Draw, advance: Advance
) -> tuple[list[Drawn], dict[str, str]]:
    """Draw those whose digest is not the `known` one, or whose files are gone.

    Returns what the page shows and the digests of what is drawn now. Where a figure cannot be drawn,
    an earlier one stays, and it is tried again next time. `advance` is called after each.
    """
    digests, errors, changed = {}, {}, []
    for placed in drawings:
        try:
            digests[placed.name] = placed.digest
        except Exception as failure:  # data of a plugin's that have no `repr`
            errors[placed.name] = what_failed(failure)
            advance()
            continue
        if known.get(placed.name) == digests[placed.name] and _is_there(folder, placed):
            advance()
        else:
            changed.append(placed)
    for placed, error in draw(changed):
        if error:  # a lost image must not cost the tables and the other figures
            errors[placed.name] = error
            del digests[placed.name]
        advance()
    return [_drawn(folder, placed, errors.get(placed.name, "")) for placed in drawings], digests


def what_failed(failure: Exception) -> str:
    """An exception in one line."""
    return " ".join(f"{type(failure).__name__}: {failure}".split())


def _is_there(folder: Path, placed: PlacedDrawing) -> bool:
    return all((folder / placed.path(extension)).is_file() for extension in EXTENSIONS)


def _drawn(folder: Path, placed: PlacedDrawing, error: str) -> Drawn:
    if not _is_there(folder, placed):
        return Drawn(placed, error, there=False)
    return Drawn(placed, error, True, _width_inches(folder / placed.path("png"), placed.drawing.dpi))


def _width_inches(png: Path, dpi: int) -> float:
    """How wide a figure is in print, from the picture's head."""
    with png.open("rb") as stream:
        head = stream.read(20)
    return int.from_bytes(head[16:20], "big") / dpi


def draw_files(folder: Path, placed: PlacedDrawing) -> None:
    """Draw into the folder, in rectbench's style; raises whatever the figure raises."""
    import matplotlib

    with matplotlib.rc_context():
        matplotlib.rcdefaults()  # a user's own matplotlibrc changes nothing here
        matplotlib.rc_file(STYLE, use_default_template=False)
        figure = placed.drawing.draw()
        if figure.get_layout_engine() is not None:
            figure.draw_without_rendering()
            figure.set_layout_engine(None)  # laid out once, not again for each file
        for extension in EXTENSIONS:
            write_atomically(folder / placed.path(extension), encode(figure, extension, placed.drawing.dpi))
