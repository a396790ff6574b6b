"""Short names for the pairs of a run, as axes and tables show them."""

from __future__ import annotations

from rectbench.plugins.result import Part

Place = tuple[str, str, str]


def pair_labels(run: Part) -> dict[Place, str]:
    """A label of each (scene, rig, motion): scene over rig; the motion where that leaves two alike."""
    places = list(dict.fromkeys(r.place for r in run.results))
    short = {place: f"{place[0]}\n{place[1]}" for place in places}
    if len(set(short.values())) == len(places):
        return short
    return {place: f"{label}\n{place[2]}" for place, label in short.items()}


def one_line(label: str) -> str:
    """A pair's label in a table."""
    return label.replace("\n", ", ")
