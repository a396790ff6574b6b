"""Where a report's pairs come from: they are rendered, or photographs found in a folder.

What looks names and files up is imported where it is used, so that stating a report, and listing reports,
loads none of it.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Self

from pydantic import BaseModel, ConfigDict, Field

from rectbench.errors import InvalidInput
from rectbench.pairs.spec import AS_CALIBRATED, PhotographedSpec, RenderedSpec

if TYPE_CHECKING:
    from rectbench.pairs.finding.photographs import Photographs

PairName = tuple[str, str, str]
"""Scene, rig, motion."""


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
    seeds: tuple[int, ...]
    metrics: tuple[str, ...]
    figures: tuple[str, ...] | None
    """None draws the usual ones."""
    rendering: Rendering
    needs_images: bool
    """Whether a pose or figure asks for images; metrics and methods may ask for them, too."""
    needs_truth: bool = False
    """Whether a metric or method asks for the truth."""
    is_open: bool = True
    """Whether methods added to a run join this part."""
    alone: bool = False
    """Whether its cells run one at a time on all cores."""


@dataclass(frozen=True)
class _Source:
    parts: tuple[StatedPart, ...]
    found: Photographs | None = None
    """What is in the folder, for photographs once they are located."""

    has_truth: ClassVar[bool] = True
    """Whether anybody knows the truth about the pairs."""
    takes_foreign_names: ClassVar[bool] = True
    """Whether a run may have scenes and rigs that the report does not name."""
    scene_word: ClassVar[str] = "scene"
    """What the first name of a pair is the name of."""


class Rendered(_Source):
    """Pairs that are rendered, so that any rig can stand in any scene."""

    def located(self, report: str, data: str | Path | None) -> Self:
        """The same; raises InvalidInput for a folder of photographs, which nobody needs."""
        if data is not None:
            raise InvalidInput(f"report {report} renders its pairs; expected no --data")
        return self

    def specs(self, part: StatedPart) -> Iterator[RenderedSpec]:
        """What is to be rendered for a part; raises UnknownName for a scene, rig or motion that is none."""
        from rectbench.experiments.naming import plugins_named, require_known, rigs_named
        from rectbench.plugins.scene import SCENES
        from rectbench.rigs.motions import MOTIONS

        names = dict.fromkeys(scene for scene, _, _ in part.pairs)
        scenes = {name: plugins_named(SCENES, [name])[0] for name in names}
        rigs = rigs_named(dict.fromkeys(rig for _, rig, _ in part.pairs))
        require_known("motion", [motion for _, _, motion in part.pairs], MOTIONS)
        for (scene, rig, motion), seed in itertools.product(part.pairs, part.seeds):
            plugin, scene_source = scenes[scene]
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


class Photographed(_Source):
    """Pairs of photographs, found in a folder that each run names."""

    has_truth = False
    takes_foreign_names = False
    scene_word = "pair"

    def located(self, report: str, data: str | Path | None) -> Photographed:
        """The same with the pairs in the folder `data`; raises InvalidInput where there are none."""
        from rectbench.pairs.finding.photographs import find_photographs

        if data is None:
            raise InvalidInput(f"report {report} takes photographs; expected a folder of them, --data FOLDER")
        found = find_photographs(data)
        pairs = tuple((pair.name, pair.calibration.name, AS_CALIBRATED) for pair in found.pairs)
        return Photographed(tuple(replace(part, pairs=pairs) for part in self.parts), found)

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


PairSource = Rendered | Photographed
