"""What a run is to have of a report: the names that are selected, in the place of its own or beside them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal

from rectbench.errors import InvalidInput
from rectbench.experiments.naming import require_known
from rectbench.experiments.pair_sources import PairName, PairSource, StatedPart
from rectbench.pairs.spec import NO_SCENE
from rectbench.plugins.result import distinct


@dataclass(frozen=True)
class Selection:
    """What to run of a report, and with which options; None runs all it names.

    A "+" before a name adds it to the report's own, in whose place the others stand.
    """

    methods: Sequence[str] | None = None
    scenes: Sequence[str] | None = None
    rigs: Sequence[str] | None = None
    seeds: Sequence[int] | None = None
    options: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    """By method; laid over the report's own."""
    margin_deg: float | None = None
    """How near to the epipoles views are trimmed; the report's own margin where left out."""

    def __post_init__(self) -> None:
        for name in ("methods", "scenes", "rigs"):
            if isinstance(given := getattr(self, name), str):  # a list of one, not of its letters
                object.__setattr__(self, name, (given,))


Selectable = Literal["methods", "scenes", "rigs", "seeds"]
_PLACES: Mapping[Literal["scenes", "rigs"], int] = {"scenes": 0, "rigs": 1}
"""Where in the name of a pair these stand."""
OwnNames = Mapping[Selectable, tuple[Any, ...]]
"""What the parts of a report name, by kind, as far as a run may select it."""


def own_names(source: PairSource, sources: Sequence[PairSource]) -> OwnNames:
    """What counts as the report's own in one part of it; a name that is none of these joins the part.

    Methods and seeds are those of all parts, and so are the scenes and rigs for lenses. For pairs with images
    the rigs that only lenses have are foreign: rendering in them is more than the report asks for.
    """
    alike = [other.part for other in sources if other.offers >= source.offers]
    own: dict[Selectable, tuple[Any, ...]] = {
        "methods": distinct(name for other in sources for name in other.part.methods),
        "seeds": distinct(seed for other in sources for seed in other.part.seeds),
    }
    for kind in source.selects:
        own[kind] = distinct(pair[_PLACES[kind]] for part in alike for pair in part.pairs)
    return own


def selects_all(chosen: Selection, own: OwnNames) -> bool:
    """Whether all that a report names itself is selected, under its own options."""
    return (
        not chosen.options
        and chosen.margin_deg is None
        and all(set(names) <= set(_chosen_names(getattr(chosen, kind), names)) for kind, names in own.items())
    )


def selected(source: PairSource, own: OwnNames, chosen: Selection) -> StatedPart:
    """A part of a report with the methods, pairs and seeds that a run is to have of it, in its own order.

    Raises UnknownName or InvalidInput for a selection that cannot be.
    """
    return replace(
        source.part,
        methods=_chosen_methods(source.part, own["methods"], chosen),
        pairs=_chosen_pairs(source, own, chosen),
        seeds=_chosen_seeds(source.part, own["seeds"], chosen),
    )


def _chosen_names(chosen: Sequence[Any] | None, own: Sequence[Any]) -> list[Any]:
    """What is run in the place of a report's `own` names; a "+" before a name adds it to them."""
    if chosen is None:
        return list(own)
    added = [name[1:] for name in chosen if isinstance(name, str) and name.startswith("+")]
    instead = [name for name in chosen if not (isinstance(name, str) and name.startswith("+"))]
    return [*(instead or (own if added else ())), *added]


def _chosen_methods(part: StatedPart, own: Sequence[str], chosen: Selection) -> tuple[str, ...]:
    """The part's own, and those that no part has."""
    names = _chosen_names(chosen.methods, own)
    foreign = [name for name in names if name not in own]
    return (*(name for name in part.methods if name in names), *(foreign if part.is_open else ()))


def _chosen_pairs(source: PairSource, own: OwnNames, chosen: Selection) -> tuple[PairName, ...]:
    pairs = source.part.pairs
    for kind in source.selects:
        place, its_own = _PLACES[kind], own[kind]
        names = _chosen_names(getattr(chosen, kind), its_own)
        if not names:
            raise InvalidInput(f"no {kind} are selected; expected at least one")
        if not source.takes_foreign_names:
            require_known(kind.removesuffix("s"), names, its_own)
        # No scene is none that rigs could stand in: it is there to select lenses alone.
        foreign = [name for name in names if name not in (*its_own, NO_SCENE)]
        kept = [pair for pair in pairs if pair[place] in names]
        # A name of the user's own takes the place of each of the part's.
        added = [_with(pair, place, name) for pair in pairs for name in foreign]
        pairs = distinct([*kept, *added])
    return pairs


def _with(pair: PairName, place: int, name: str) -> PairName:
    scene, rig, motion = (name if i == place else own for i, own in enumerate(pair))
    return scene, rig, motion


def _chosen_seeds(part: StatedPart, own: Sequence[int], chosen: Selection) -> tuple[int, ...]:
    """The part's own, and those that no part has."""
    seeds = _chosen_names(chosen.seeds, own)
    for seed in seeds:
        if isinstance(seed, bool) or not isinstance(seed, int) or seed < 0:
            raise InvalidInput(f"seed is {seed!r}; expected a whole number from 0 on")
    if not seeds:
        raise InvalidInput("no seeds are selected; expected at least one")
    return distinct(seed for seed in seeds if seed in part.seeds or seed not in own)
