"""A figure to be, and drawing only those that changed."""

from __future__ import annotations

import hashlib
import importlib.metadata
import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rectbench.progress import Advance
from rectbench.reporting.style import PAGE_INCHES, STYLE, encode
from rectbench.store.keys import code_digest
from rectbench.writing import write_atomically

if TYPE_CHECKING:
    from matplotlib.figure import Figure

EXTENSIONS = ("pdf", "svg", "png")


@dataclass(frozen=True)
class Plan:
    """A figure to be: its words, what it is made from, how it is drawn."""

    name: str
    kind: str
    title: str
    caption: str
    made_from: Any = field(repr=False)
    draw: Callable[[], Figure] = field(repr=False)
    dpi: int = 160
    shown_as: str = "svg"
    part: str = ""
    """The part of the report it belongs to."""

    @property
    def digest(self) -> str:
        """Changes with whatever changes the picture."""
        text = json.dumps([self.name, self.dpi, self.made_from, _code_digest()], default=repr, sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()

    def path(self, extension: str) -> str:
        """Where the figure lies in the run's folder."""
        return f"figures/{self.name}.{extension}"


@dataclass(frozen=True)
class Drawn:
    """A figure on the page: drawn, or not and why, or left there by an earlier report of the folder."""

    plan: Plan
    error: str = ""
    there: bool = True
    width_inches: float = PAGE_INCHES


def draw_changed(
    folder: Path, plans: list[Plan], known: Mapping[str, str], advance: Advance
) -> tuple[list[Drawn], dict[str, str]]:
    """Draw the plans whose digest is not the `known` one, or whose files are gone.

    Returns what the page shows and the digests of what is drawn now. Where a figure cannot be drawn,
    an earlier one stays, and it is tried again next time. `advance` is called after each.
    """
    drawn, digests = [], {}
    for plan in plans:
        digest, error = plan.digest, ""
        there = all((folder / plan.path(extension)).is_file() for extension in EXTENSIONS)
        if known.get(plan.name) != digest or not there:
            try:
                _draw(folder, plan)
                there = True
            except Exception as failure:  # a lost image must not cost the tables and the other figures
                error = " ".join(f"{type(failure).__name__}: {failure}".split())
        if not error:
            digests[plan.name] = digest
        width = _width_inches(folder / plan.path("png"), plan.dpi) if there else PAGE_INCHES
        drawn.append(Drawn(plan, error, there, width))
        advance()
    return drawn, digests


def _width_inches(png: Path, dpi: int) -> float:
    """How wide a figure is in print, from the picture's head."""
    with png.open("rb") as stream:
        head = stream.read(20)
    return int.from_bytes(head[16:20], "big") / dpi


def _draw(folder: Path, plan: Plan) -> None:
    import matplotlib

    with matplotlib.rc_context():
        matplotlib.rcdefaults()  # a user's own matplotlibrc changes nothing here
        matplotlib.rcParams.update(STYLE)
        figure = plan.draw()
        if figure.get_layout_engine() is not None:
            figure.draw_without_rendering()
            figure.set_layout_engine(None)  # laid out once, not again for each file
        for extension in EXTENSIONS:
            write_atomically(folder / plan.path(extension), encode(figure, extension, plan.dpi))


@cache
def _code_digest() -> str:
    """The code that draws and that computes for pictures alone, and the version of matplotlib."""
    digest = hashlib.sha256(importlib.metadata.version("matplotlib").encode())
    digest.update(code_digest("rectbench.reporting").encode())
    return digest.hexdigest()
