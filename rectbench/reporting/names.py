"""What pairs are called on axes and in tables, and the files of tables and figures."""

from __future__ import annotations

import re

from rectbench.pairs.spec import NO_SCENE
from rectbench.plugins.result import Part
from rectbench.store.keys import digest

LONGEST_STEM = 120
"""Letters; file systems take 255 bytes, the suffix among them."""


def slug(*parts: str) -> str:
    """A file's stem from names: lower case, hyphens, nothing a shell or LaTeX minds.

    Names without a letter or digit of these, or too long for a file, give way to a digest.
    """
    words = (re.sub(r"[^a-z0-9]+", "-", part.lower()).strip("-") for part in parts)
    stem = "-".join(filter(None, words))
    return stem if 0 < len(stem) <= LONGEST_STEM or not any(parts) else digest(list(parts))[:12]


def named(part: Part, stem: str, *parts: str) -> str:
    """A file's stem that holds the name of the report's part, once."""
    return slug(stem, "" if part.group == stem else part.group, *parts)


def pair_labels(run: Part) -> dict[tuple[str, str, str], str]:
    """A label of each (scene, rig, motion): any scene over the rig; the motion where two are alike."""
    places = list(dict.fromkeys(r.place for r in run.results))
    short = {place: place[1] if place[0] == NO_SCENE else f"{place[0]}\n{place[1]}" for place in places}
    if len(set(short.values())) == len(places):
        return short
    return {place: f"{label}\n{place[2]}" for place, label in short.items()}


def one_line(label: str) -> str:
    """A pair's label in a table."""
    return label.replace("\n", ", ")
