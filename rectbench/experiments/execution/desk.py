"""What a process that runs cells has at hand: the last pair and the last scene."""

from __future__ import annotations

from rectbench.pairs.opening import open_pair
from rectbench.pairs.pair import Pair
from rectbench.pairs.rendering import Studio
from rectbench.pairs.spec import PhotographedSpec, RenderedSpec
from rectbench.store.store import Store


class Desk:
    """Keeps one pair and one scene: cells of one pair run one after another, as pairs of one scene do."""

    def __init__(self) -> None:
        self._studio = Studio()
        self._pair: Pair | None = None

    def pair(self, spec: RenderedSpec | PhotographedSpec, store: Store) -> Pair:
        """The pair that is meant, with all that was found of it if it was the last one too."""
        if self._pair is None or (self._pair.spec, self._pair.store) != (spec, store):
            self._pair = None  # two pairs at once are a gigabyte
            self._pair = open_pair(spec, store, self._studio)
        return self._pair

    def clear(self) -> None:
        """Put both away."""
        self._studio, self._pair = Studio(), None


DESK = Desk()
"""That of this process."""
