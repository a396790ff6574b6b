"""What a method says of itself stands beside its numbers, and judges nothing."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

import pytest

import rectbench as rb
from rectbench.plugins.fitting import checked_result
from rectbench.plugins.rectifier import pose_problem
from rectbench.runs.making import run

METHOD = '''
import rectbench as rb


class Gnomonic(rb.Target):
    """A perspective image that is not called one."""

    constants = {{"f": 200.0}}

    def project_formula(self, c, x, y, z, xp):
        return c.f * x / z + 300.0, c.f * y / z + 300.0, z > 0.0

    def unproject_formula(self, c, u, v, xp):
        x, y = (u - 300.0) / c.f, (v - 300.0) / c.f
        length = xp.sqrt(x * x + y * y + 1.0)
        return x / length, y / length, 1.0 / length, length > 0.0


class Bent(rb.Perspective):
    """Called a perspective image, which it is not."""

    @property
    def constants(self):
        return {{"f": 200.0}}

    def project_formula(self, c, x, y, z, xp):
        return c.f * xp.atan2(x, xp.hypot(y, z)) + 300.0, c.f * xp.atan2(y, z) + 300.0, z > 0.0

    def unproject_formula(self, c, u, v, xp):
        gamma, beta = (u - 300.0) / c.f, (v - 300.0) / c.f
        rays = xp.sin(gamma), xp.cos(gamma) * xp.sin(beta), xp.cos(gamma) * xp.cos(beta)
        return *rays, (abs(gamma) < 1.5) & (abs(beta) < 1.5)


class Fake(rb.Rectifier):
    """A map that says what it is."""

    name = "fake"

    def fit(self, problem, options):
        target = {target}
        notes = {{"projection": "perspective", "focal_px": 200.0}}
        return rb.Rectification.from_targets(problem.rig, target, target, (600, 600), notes)
'''
BENT = "Bent(rb.Perspective.from_focal(200.0, 300.0, 300.0).matrix)"


@pytest.mark.parametrize(
    ("target", "projection"),
    [
        (BENT, None),
        ("rb.Epipolar(*[rb.Radial('equidistant', 200.0, 300.0)] * 2)", None),
        ("Gnomonic()", "perspective"),
        ("rb.Perspective.from_focal(200.0, 300.0, 300.0)", "perspective"),
    ],
    ids=["named", "stated", "unnamed", "known"],
)
def test_an_image_is_a_perspective_one_by_its_map_whatever_its_method_says(
    tmp_path: Path, target: str, projection: str | None
) -> None:
    method = tmp_path / "fake.py"
    method.write_text(METHOD.format(target=target))
    report = rb.Report(
        name="small",
        title="S",
        description="S.",
        rigs=("t265",),
        poses=("exact",),
        methods=(str(method),),
        metrics=("view",),
    )
    table = run(report, tmp_path / "run", jobs=1)
    assert list(table["status"]) == ["ok"], table["reason"][0]
    notes = json.loads(table["notes"][0])
    assert (notes.get("projection"), notes["focal_px"]) == (projection, 200.0)


def test_what_a_method_does_to_its_result_afterwards_changes_nothing() -> None:
    rig = rb.load_rig("t265")
    made = rb.rectify(rig, "abraham")
    checked = checked_result("abraham", made, pose_problem(rig))
    before = checked.left.forward([400.0, 300.0])
    cast(dict[str, Any], made.notes)["focal_px"] = "mine"
    other = replace(rb.rectify(rig, "conventional").left)
    object.__setattr__(made.left, "target", other.target)
    object.__setattr__(made, "right", other)
    object.__setattr__(made, "size", (1, 1))
    assert "mine" not in checked.notes.values()
    assert checked.size != (1, 1)
    assert checked.right is not other
    assert (checked.left.forward([400.0, 300.0]) == before).all()
