"""From which pair is meant to the pair."""

from __future__ import annotations

from rectbench.pairs.lenses import LensPair
from rectbench.pairs.pair import Pair
from rectbench.pairs.photographed import PhotographedPair
from rectbench.pairs.rendered import RenderedPair
from rectbench.pairs.rendering import Studio
from rectbench.pairs.spec import LensSpec, PairSpec, PhotographedSpec, RenderedSpec
from rectbench.store.store import Store


def open_pair(spec: PairSpec, store: Store, studio: Studio | None = None) -> Pair:
    """The pair that is meant; nothing is read or rendered yet. `studio` renders what the store lacks."""
    match spec:
        case RenderedSpec():
            return RenderedPair(spec=spec, store=store, studio=studio or Studio())
        case PhotographedSpec():
            return PhotographedPair(spec=spec, store=store)
        case LensSpec():
            return LensPair(spec=spec, store=store)
