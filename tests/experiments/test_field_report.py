from __future__ import annotations

from rectbench.calibrations import rig_names
from rectbench.experiments.planning import find_report
from rectbench.plugins.rectifier import METHODS, is_built_in
from rectbench.registry import registry

FIELD = find_report("field")


def test_the_field_is_every_method_that_ships_with_rectbench() -> None:
    built_in = {plugin.name for plugin in registry(METHODS).plugins() if is_built_in(plugin)}
    assert {name for part in FIELD.parts for name in part.methods} == built_in


def test_its_census_is_of_every_rig_that_ships_with_rectbench() -> None:
    census = next(part for part in FIELD.parts if part.name == "census")
    assert {rig for _, rig, _ in census.pairs} == set(rig_names())


def test_all_four_modes_of_cv2_omnidir_are_in_it() -> None:
    modes = {"longlati", "perspective", "cylindrical", "stereographic"}
    assert all({given["mode"] for given in part.options["opencv-omnidir"]} == modes for part in FIELD.parts)
