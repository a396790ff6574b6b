"""A pair rendered as a report renders it, and its files."""

from __future__ import annotations

from pathlib import Path

from rectbench.applications.one_rig import rig_of
from rectbench.applications.requests.rendering import RenderRequest
from rectbench.images.stereo_pair import StereoPair
from rectbench.pairs.rendering import placed, render_seed
from rectbench.plugins.scene import SCENES
from rectbench.registry import registry
from rectbench.rendering.truth import Truth


def render(request: RenderRequest) -> tuple[StereoPair, Truth]:
    """The images and the truth about them; raises what `rectbench.render` raises."""
    from rectbench.rendering.pair import render_pair  # needs Mitsuba

    scene, motion, seed = registry(SCENES).get(request.scene), request.motion, request.seed
    rig = rig_of(request)
    return render_pair(
        scene.value.build(seed),
        placed(rig, scene.name, motion, seed, request.image_width),
        seed=render_seed(scene.name, rig.name, motion, seed),
        spp=request.spp,
        quality=request.quality,
    )


def save_rendered(pair: StereoPair, truth: Truth, folder: Path) -> None:
    """Write left.png, right.png, truth.npz, the truth as EXRs, and rig.yaml."""
    pair.save(folder)
    truth.save(folder / "truth.npz")
    truth.save_exr(folder)
    truth.rig.save(folder / "rig.yaml")
