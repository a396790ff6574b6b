"""How every figure looks, and how it is written so that the same data give the same bytes."""

from __future__ import annotations

import hashlib
import io
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from rectbench.reporting.tables.numbers import decade

if TYPE_CHECKING:
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure

COLUMN_INCHES = 3.5
PAGE_INCHES = 7.16
"""Widths of one and of both columns of an IEEE page."""

INK = "#222222"
FAINT = "#8a8a8a"
PAPER = "#ffffff"
LOST = "#d9d9d9"

STYLE: dict[Any, Any] = {
    "font.family": "DejaVu Sans",
    "font.size": 7,
    "axes.titlesize": 7,
    "axes.titlelocation": "left",
    "axes.titlepad": 4,
    "axes.labelsize": 7,
    "axes.labelpad": 2,
    "axes.edgecolor": INK,
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.axisbelow": True,
    "axes.grid": False,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.5,
    "xtick.labelsize": 6.5,
    "ytick.labelsize": 6.5,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.minor.width": 0.4,
    "ytick.minor.width": 0.4,
    "legend.fontsize": 7,
    "legend.frameon": False,
    "legend.handlelength": 1.2,
    "legend.handletextpad": 0.5,
    "legend.columnspacing": 1.4,
    "lines.linewidth": 1.0,
    "figure.facecolor": PAPER,
    "figure.constrained_layout.w_pad": 0.02,
    "figure.constrained_layout.h_pad": 0.02,
    "figure.constrained_layout.wspace": 0.02,
    "figure.constrained_layout.hspace": 0.02,
    "savefig.facecolor": PAPER,
    "text.parse_math": False,
    "pdf.fonttype": 42,
    "ps.fonttype": 42,
    "svg.fonttype": "path",
    "svg.hashsalt": "rectbench",
}

_FIXED = {
    "conventional": ("#56b4e9", "s"),
    "abraham": ("#0072b2", "o"),
    "hartley": ("#e69f00", "^"),
    "fusiello": ("#cc79a7", "v"),
    "local-homography": ("#d55e00", "D"),
}
_SPARE = (
    ("#009e73", "P"),
    ("#332288", "X"),
    ("#999933", "<"),
    ("#882255", ">"),
    ("#666666", "h"),
    ("#44aa99", "p"),
    ("#ddaa33", "*"),
    ("#117733", "d"),
)
# Okabe & Ito's palette, then darker ones of Tol's: told apart under all common colour blindness.


def looks(methods: Sequence[str]) -> dict[str, tuple[str, str]]:
    """Colour and marker of each method: fixed for the built-in ones, steered by the name for others.

    A name's own hash picks its place among the spare looks, so that a method keeps its colour from
    one run to the next unless two names want the same.
    """
    chosen: dict[str, tuple[str, str]] = {}
    for method in sorted(set(methods)):
        if method in _FIXED:
            chosen[method] = _FIXED[method]
            continue
        start = int.from_bytes(hashlib.sha256(method.encode()).digest()[:4], "big")
        places = [_SPARE[(start + i) % len(_SPARE)] for i in range(len(_SPARE))]
        chosen[method] = next((look for look in places if look not in chosen.values()), places[0])
    return chosen


def plain_log_ticks(axis: Axis) -> None:
    """Label a logarithmic axis 0.1, 1, 10, 100, and with powers of ten beyond; 2 and 5 on a short one."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    low, high = axis.get_view_interval()
    short = high < 100 * low
    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if short else (1.0,)))
    axis.set_major_formatter(FuncFormatter(lambda value, _: decade(value)))
    axis.set_minor_formatter(NullFormatter())


def encode(figure: Figure, extension: str, dpi: int) -> bytes:
    """The figure as a PDF, SVG or PNG file; `dpi` also sets the detail of images within it."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format=extension, dpi=dpi, metadata=_METADATA[extension])
    return buffer.getvalue()


_METADATA: dict[str, dict[str, Any]] = {
    "pdf": {"CreationDate": None, "Creator": None},
    "svg": {"Date": None},
    "png": {"Software": None},
}
"""No times and no versions, so that equal pictures are equal files."""
