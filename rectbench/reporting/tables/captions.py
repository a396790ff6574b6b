"""What stands above a table in words: over what it averages, and by which rule each column."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

from rectbench.pairs.spec import NO_SCENE
from rectbench.plugins.metric import Average, Column
from rectbench.plugins.result import Result, distinct

_RULES: dict[Average, str] = {
    "geometric": "geometric means of",
    "rms": "root mean squares of",
    "max": "the largest of",
    "min": "the smallest of",
    "mean": "arithmetic means of",
}


def averages_text(results: Sequence[Result], columns: Sequence[Column], scene: str = "scene") -> str:
    """What the averages of a table are over, and of what kind."""
    return f"{_rules_text(columns)} over {units_text(results, scene)}."


def units_text(results: Iterable[Result], scene: str = "scene") -> str:
    """The rigs, and what each holds where all hold the same; `scene` is what a scene is called.

    >>> units_text([])
    '0 rigs'
    """
    held: dict[str, set[tuple[str, str, int]]] = {}
    for r in results:
        held.setdefault(r.rig, set()).add((r.motion, r.scene, r.seed))
    rigs = counted(len(held), "rig")
    if not held:
        return rigs
    first = next(iter(held.values()))
    levels = [distinct(key[level] for key in first) for level in range(3)]
    is_grid = len(levels[0]) * len(levels[1]) * len(levels[2]) == len(first)
    counts = [(levels[0], "motion"), (levels[1], scene), (levels[2], "seed")]
    if not is_grid or len({len(one) for one in held.values()}) > 1:
        return f"{rigs} ({counted(sum(map(len, held.values())), 'pair')} in all)"
    each = [
        counted(len(names), noun)
        for names, noun in counts
        if len(names) > 1 or (noun == scene and names != (NO_SCENE,))
    ]
    return f"{rigs} ({' × '.join(each)}{' each' if len(held) > 1 else ''})" if each else rigs


def _rules_text(columns: Sequence[Column]) -> str:
    """By which rule each column is averaged, in the fewest words."""
    groups = {rule: [c.heading for c in columns if c.average == rule] for rule in _RULES}
    groups = {rule: headings for rule, headings in groups.items() if headings}
    if set(groups) <= {"mean"}:
        return "Means"
    if len(groups) == 1:
        return capitalised(_RULES[next(iter(groups))].removesuffix(" of"))
    told = [
        f"{_RULES[rule]} {listed(_stems(headings, columns, rule))}"
        for rule, headings in groups.items()
        if rule != "mean"
    ]
    return capitalised(", ".join([*told, *[f"{_RULES['mean']} the rest"] * ("mean" in groups)]) + ",")


def _stems(headings: Sequence[str], columns: Sequence[Column], rule: Average) -> tuple[str, ...]:
    """The headings without what follows their commas, where no column of another rule reads alike then."""
    others = {_stem(c.heading) for c in columns if c.average != rule}
    return distinct(heading if _stem(heading) in others else _stem(heading) for heading in headings)


def _stem(heading: str) -> str:
    return re.split(r", | at | \(", heading)[0]


def listed(names: Sequence[str]) -> str:
    """Names in a sentence.

    >>> listed(["a", "b", "c"])
    'a, b and c'
    """
    return " and ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)


def capitalised(text: str) -> str:
    """The text with its first letter large, the others as they are.

    >>> capitalised("a JPEG")
    'A JPEG'
    """
    return text[:1].upper() + text[1:]


def counted(n: int, noun: str) -> str:
    """How many things, in words.

    >>> counted(2, "rig")
    '2 rigs'
    """
    return f"{n} {noun}{'' if n == 1 else 's'}"
