"""Where the pairs of a report's parts come from: they are rendered, found in a folder, or lenses alone.

What looks names and files up is imported where it is used, so that stating a report, and listing reports,
loads none of it.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Set
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Self

from pydantic import BaseModel, ConfigDict, Field

from rectbench.errors import InvalidInput, argument
from rectbench.pairs.spec import (
    AS_CALIBRATED,
    CALIBRATED,
    ESTIMATED,
    NO_SCENE,
    LensSpec,
    PhotographedSpec,
    RenderedSpec,
)
from rectbench.plugins.matches import true_noise_px

if TYPE_CHECKING:
    from rectbench.pairs.finding.photographs import Photographs
    from rectbench.plugins.metric import Need

NOTHING_DRAWN = 0
"""The seed of cells for which no seed draws anything."""

PairName = tuple[str, str, str]
"""Scene, rig, motion; the scene is NO_SCENE for lenses alone."""


class Rendering(BaseModel):
    """How pairs are rendered."""

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)

    image_width: int | None = Field(default=None, ge=16)
    """Width to which rigs are scaled, pixels; None keeps their own."""
    quality: Literal["path", "fast"] = "path"
    """Path tracing, or the fast integrator."""
    spp: int = Field(default=64, ge=1)
    """Samples a pixel."""


@dataclass(frozen=True)
class StatedPart:
    """A part of a report: all the cells of its pairs × poses × methods × seeds, and what is made of them."""

    name: str
    """Empty where the report is one part."""
    title: str
    pairs: tuple[PairName, ...]
    """Empty for photographs that have not been looked for yet."""
    methods: tuple[str, ...]
    options: Mapping[str, tuple[dict[str, Any], ...]]
    """By method: the sets of options it runs with, each a row of its own."""
    poses: tuple[str, ...]
    matches: tuple[str, ...]
    """Levels of the matches that those methods get which work from matches."""
    seeds: tuple[int, ...]
    metrics: tuple[str, ...]
    figures: tuple[str, ...] | None
    """None draws the usual ones."""
    rendering: Rendering
    needs_images: bool = False
    """Whether anything asks for images; known once it is planned, as is the next."""
    needs_truth: bool = False
    is_open: bool = True
    """Whether methods added to a run join this part."""
    alone: bool = False
    """Whether its cells run one at a time on all cores."""


@dataclass(frozen=True)
class _Source:
    part: StatedPart
    found: Photographs | None = None
    """What is in the folder, for photographs once they are located."""

    pairs_called: ClassVar[str]
    """What errors call its pairs."""
    offers: ClassVar[frozenset[Need]]
    """What its pairs have beside their rig: metrics, figures and poses that need more are refused."""
    true_matches: ClassVar[bool] = True
    """Whether methods can be given true matches."""
    has_truth: ClassVar[bool] = True
    """Whether anybody knows how the cameras truly stand."""
    selects: ClassVar[tuple[Literal["scenes", "rigs"], ...]] = ("scenes", "rigs")
    """Which of its names a run may select,"""
    takes_foreign_names: ClassVar[bool] = True
    """and whether these may be others than the report's."""
    scene_word: ClassVar[str] = "scene"
    """What the first name of a pair is the name of."""

    def located(self, report: str, data: str | Path | None) -> Self:
        """The same; raises InvalidInput for a folder of photographs, which nobody needs."""
        if data is not None:
            raise InvalidInput(f"report {report} takes no photographs; expected no {argument('data')}")
        return self

    def require_poses(self) -> None:
        """Raise UnknownName for a level of pose that is none, InvalidInput for one its pairs cannot have."""
        from rectbench.experiments.naming import require_known
        from rectbench.rigs.poses import POSES

        require_known("pose", self.part.poses, (*POSES, ESTIMATED))
        if ESTIMATED in self.part.poses and "images" not in self.offers:
            raise InvalidInput(f"pose estimated needs images, which {self.pairs_called} have not")

    def match_levels(self, needs: Set[str]) -> tuple[str, ...]:
        """The levels of matches that a method of these needs runs at: one without a name if it needs none."""
        if "matches" not in needs:
            return ("",)
        from_images = "images" in self.offers
        return tuple(
            level
            for level in self.part.matches
            if (from_images if true_noise_px(level) is None else self.true_matches)
        )

    def lacks(self, needs: Set[str]) -> str:
        """What is needed and its pairs have not, in words that end an error; empty where they have all."""
        for need, called in (("truth", "the truth"), ("images", "images"), ("true_matches", "true matches")):
            if need in needs and need not in self.offers:
                return f"{called}, which {self.pairs_called} have not"
        if not self.match_levels(needs):
            stated = ", ".join(self.part.matches)
            return (
                f"matches, and {self.pairs_called} have none of {stated}; expected true + 0.1 px, or the like"
            )
        return ""

    def has_cell(self, part: StatedPart, seed: int, pose: str, matches: str) -> bool:
        """Whether a part has a cell at these levels of pose and matches on a pair of this seed."""
        return True


class Rendered(_Source):
    """Pairs that are rendered, so that any rig can stand in any scene."""

    pairs_called = "rendered pairs"
    offers = frozenset({"truth", "images", "true_matches"})

    def specs(self, part: StatedPart) -> Iterator[RenderedSpec]:
        """What is to be rendered for a part; raises UnknownName for a scene, rig or motion that is none."""
        from rectbench.experiments.naming import plugins_named
        from rectbench.plugins.scene import SCENES

        names = dict.fromkeys(scene for scene, _, _ in part.pairs)
        scenes = {name: plugins_named(SCENES, [name])[0] for name in names}
        rigs = _rigs_moved(part)
        for (scene, rig, motion), seed in itertools.product(part.pairs, part.seeds):
            plugin, scene_source = scenes[scene]
            if plugin.name == NO_SCENE:
                raise InvalidInput(
                    f"{plugin.path}: scene {NO_SCENE} stands for no scene; expected another name"
                )
            rig_name, rig_source = rigs[rig]
            yield RenderedSpec(
                scene=plugin.name,
                rig=rig_name,
                motion=motion,
                seed=seed,
                scene_source=scene_source,
                rig_source=rig_source,
                truth=part.needs_truth,
                images=part.needs_images,
                **part.rendering.model_dump(),
            )


class Lenses(_Source):
    """Rigs and their motions without a scene: nothing is rendered."""

    pairs_called = "lenses without a scene"
    offers = frozenset({"true_matches"})
    selects = ("rigs",)

    def specs(self, part: StatedPart) -> Iterator[LensSpec]:
        """The pairs of a part; raises UnknownName for a rig or motion that is none."""
        rigs = _rigs_moved(part)
        seeds = dict.fromkeys((NOTHING_DRAWN, *part.seeds))
        for (_, rig, motion), seed in itertools.product(part.pairs, seeds):
            rig_name, rig_source = rigs[rig]
            yield LensSpec(
                rig=rig_name,
                motion=motion,
                seed=seed,
                rig_source=rig_source,
                image_width=part.rendering.image_width,
            )

    def has_cell(self, part: StatedPart, seed: int, pose: str, matches: str) -> bool:
        """Where a seed draws nothing, one cell stands for those of all seeds, whatever they are."""
        from rectbench.rigs.poses import POSES

        is_drawn = POSES[pose] != POSES["exact"] or bool(true_noise_px(matches))
        return seed in part.seeds if is_drawn else seed == NOTHING_DRAWN


class Photographed(_Source):
    """Pairs of photographs, found in a folder that each run names."""

    pairs_called = "photographs"
    offers = frozenset({"images"})
    true_matches = False
    has_truth = False
    takes_foreign_names = False
    scene_word = "pair"

    def require_poses(self) -> None:
        """Raise InvalidInput for a level that photographs cannot have."""
        for pose in self.part.poses:
            if pose not in (CALIBRATED, ESTIMATED):
                raise InvalidInput(f"pose of photographs is {pose}; expected {CALIBRATED} or {ESTIMATED}")

    def located(self, report: str, data: str | Path | None) -> Self:
        """The same with the pairs in the folder `data`; raises InvalidInput where there are none."""
        from rectbench.pairs.finding.photographs import find_photographs

        if data is None:
            expected = f"a folder of them, {argument('data')}"
            raise InvalidInput(f"report {report} takes photographs; expected {expected}")
        found = find_photographs(data)
        pairs = tuple((pair.name, pair.calibration.name, AS_CALIBRATED) for pair in found.pairs)
        return replace(self, part=replace(self.part, pairs=pairs), found=found)

    def specs(self, part: StatedPart) -> Iterator[PhotographedSpec]:
        """The photographs of a part, which are what they are: nothing about them can be asked for."""
        assert self.found is not None, "photographs are located before they are planned"
        of_name = {(pair.name, pair.calibration.name): pair for pair in self.found.pairs}
        for (scene, rig, motion), seed in itertools.product(part.pairs, part.seeds):
            pair = of_name[scene, rig]
            calibration = pair.calibration
            yield PhotographedSpec(
                scene=scene,
                rig=rig,
                motion=motion,
                seed=seed,
                left=str(pair.left),
                right=str(pair.right),
                calibration=tuple(map(str, calibration.files)),
                size=calibration.size,
                unit=calibration.unit,
                max_angle_deg=calibration.max_angle_deg,
                cameras=calibration.cameras,
            )


PairSource = Rendered | Photographed | Lenses


def _rigs_moved(part: StatedPart) -> dict[str, tuple[str, str]]:
    """By what a part calls them: name and source of its rigs; its motions are looked up as well."""
    from rectbench.experiments.naming import require_known, rigs_named
    from rectbench.rigs.motions import MOTIONS

    require_known("motion", [motion for _, _, motion in part.pairs], MOTIONS)
    return rigs_named(dict.fromkeys(rig for _, rig, _ in part.pairs))
