"""What `rectbench list` can list: names with a line about each, and plugins that cannot be loaded."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pkgutil import resolve_name
from typing import TYPE_CHECKING, Any, NamedTuple

from rectbench.errors import UnknownName

if TYPE_CHECKING:
    from rectbench.cameras import Camera
    from rectbench.registry import Kind

LISTABLE = {
    "methods": "rectbench.plugins.rectifier:METHODS",
    "scenes": "rectbench.plugins.scene:SCENES",
    "rigs": "rectbench.applications.listing:_rigs",
    "motions": "rectbench.applications.listing:_motions",
    "poses": "rectbench.applications.listing:_poses",
    "metrics": "rectbench.plugins.metric:METRICS",
    "matchers": "rectbench.matching.dense.matcher:MATCHERS",
    "reports": "rectbench.experiments.spec:REPORTS",
    "figures": "rectbench.plugins.figure:FIGURES",
    "formats": "rectbench.rigs.file_formats:FORMATS",
}
"""Where each kind is: a `Kind` of plugins, or a function that gives entries. Imported when it is listed."""


class Entry(NamedTuple):
    """One thing with a name."""

    name: str
    summary: str
    value: Any = None
    """The plugin, of a kind of plugins."""
    columns: tuple[str, ...] = ()
    """Of a metric, what its numbers are called in rows and by `--metric`."""


@dataclass(frozen=True)
class Listing:
    """What there is of a kind."""

    entries: tuple[Entry, ...]
    broken: Mapping[str, str] = field(default_factory=dict)
    """Why a plugin at a place cannot be loaded."""


def plugin_kinds() -> list[Kind[Any]]:
    """The kinds of plugins among what can be listed."""
    return [source for place in LISTABLE.values() if not callable(source := resolve_name(place))]


def listed(kind: str) -> Listing:
    """All there is of a kind. Raises UnknownName for a kind that there is not."""
    from rectbench.registry import registry

    if kind not in LISTABLE:
        raise UnknownName("kind", kind, LISTABLE)
    source = resolve_name(LISTABLE[kind])
    if callable(source):
        return Listing(tuple(source()))
    found = registry(source)
    entries = (
        Entry(plugin.name, plugin.summary, plugin.value, _columns(plugin.value)) for plugin in found.plugins()
    )
    return Listing((*entries, *(_bundles() if kind == "metrics" else ())), found.broken)


def _columns(value: Any) -> tuple[str, ...]:
    from rectbench.plugins.metric import Metric

    return tuple(column.key for column in value.columns) if isinstance(value, Metric) else ()


def _bundles() -> Iterator[Entry]:
    from rectbench.metrics.scoring import BUNDLES

    return (Entry(name, f"Together: {', '.join(members)}.") for name, members in BUNDLES.items())


def _rigs() -> Iterator[Entry]:
    from rectbench.calibrations import load_rig, rig_names

    for name in rig_names():
        rig = load_rig(name)
        size, baseline_mm = f"{rig.left.width}x{rig.left.height}", 1000 * rig.baseline_m
        across, down = _fields_of_view_deg(rig.left)
        view = f"{across:.0f}° x {down:.0f}°"
        yield Entry(name, f"{rig.left.model}, {size}, {view}, baseline {baseline_mm:.0f} mm")


def _fields_of_view_deg(camera: Camera) -> tuple[float, float]:
    """The angles that the image's row and column through the lens's axis span, degrees."""
    import numpy as np

    axis, _ = camera.project([0.0, 0.0, 1.0])
    spans = []
    for along in (0, 1):
        places = np.arange(-0.5, camera.size[along])
        line = np.tile(axis, (len(places), 1))
        line[:, along] = places
        rays, seen = camera.unproject(line)
        x, y, z = rays[seen][[0, -1]].T
        spans.append(float(np.degrees(np.arctan2(np.hypot(x, y), z)).sum()))
    return spans[0], spans[1]


def _motions() -> Iterator[Entry]:
    from rectbench.rigs import MOTIONS

    return (Entry(motion.name, motion.description) for motion in MOTIONS.values())


def _poses() -> Iterator[Entry]:
    from rectbench.pairs.spec import ESTIMATED
    from rectbench.rigs import POSES

    for name, noise in POSES.items():
        rotation, direction = f"{noise.rotation_deg:g}°", f"{noise.direction_deg:g}°"
        yield Entry(name, f"rotation off by {rotation}, baseline by {direction}")
    yield Entry(ESTIMATED, "found in the images: features, five points, bundle adjustment")
