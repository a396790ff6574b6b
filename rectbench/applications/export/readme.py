"""The README of an exported dataset: its conventions, with its own numbers, and how each file is read.

The Python in `README.md.j2` runs as it stands from the dataset's folder (the tests do so).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

Pairs = Sequence[Mapping[str, Any]]


def readme_text(settings: Mapping[str, Any], pairs: Pairs) -> str:
    """The README of a dataset of at least one pair, in Markdown."""
    paths = sorted(path for pair in pairs for path in pair["files"])
    folders = {path.rpartition("/")[0] for path in paths}
    environment = Environment(
        loader=PackageLoader("rectbench", "applications/export"),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters |= {"sizes": _sizes, "span": _span, "ends": _ends}
    return environment.get_template("README.md.j2").render(
        settings=settings,
        pairs=pairs,
        z_folders=[folder for folder in ("z_left", "z_right") if folder in folders],
        calibrations=dict.fromkeys(
            path.rpartition("/")[2] for path in paths if path.startswith("calibration/")
        ),
    )


def _sizes(pairs: Pairs, key: str) -> str:
    """The least and the greatest size, as one where they are alike."""
    found = [f"{width}x{height}" for width, height in sorted({tuple(pair[key]) for pair in pairs})]
    return found[0] if len(found) == 1 else f"{found[0]} to {found[-1]}"


def _span(pairs: Pairs, key: str, unit: str, scale: float = 1.0) -> str:
    """The least and the greatest value of numbers, or of ranges that may be None; as one where alike."""
    values = [pair[key] for pair in pairs if pair[key] is not None]
    numbers = [scale * end for value in values for end in (value if isinstance(value, list) else [value])]
    if not numbers:
        return "none"
    low, high = f"{min(numbers):.4g}", f"{max(numbers):.4g}"
    return f"{low} {unit}" if low == high else f"{low} to {high} {unit}"


def _ends(camera: Mapping[str, Any]) -> str:
    """Where a lens's image circle ends."""
    end = camera["max_angle_deg"]
    return f"{end:g}°" if end else "no bound"
