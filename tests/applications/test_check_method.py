from __future__ import annotations

from pathlib import Path

import pytest

from rectbench.applications.check_method import RIGS, CheckResult, check_method
from rectbench.plugins.rectifier import METHODS
from rectbench.registry import registry
from tests.experiments.fakes import write_method


def findings(path: str) -> list[CheckResult]:
    return list(check_method(registry(METHODS).get(path)))


def failed(path: str) -> dict[str, str]:
    return {finding.check: finding.detail for finding in findings(path) if finding.result == "failed"}


def test_a_sound_method_passes_on_every_rig(tmp_path: Path) -> None:
    found = findings(write_method(tmp_path, "sound"))
    assert {finding.result for finding in found} == {"passed"}
    assert {finding.rig for finding in found} == {"-", *RIGS}


WARP = """
class Odd(rb.Warp):
    def {method}(self, px):
        return {value}
angles = problem.angle_warps()
target = rb.Epipolar(rb.Radial("equidistant", 100.0, 150.0), rb.Radial("equidistant", 100.0, 150.0))
sides = [Odd(warp.source, warp.R_rect_cam, target) for warp in angles]
return rb.Rectification(problem.rig, *sides, (300, 300))
"""

FAULTS = {
    "inverse": ("closure", WARP.format(method="inverse", value="super().inverse(px) + 1e-3")),
    "jacobian": ("jacobian", WARP.format(method="jacobian", value="super().jacobian(px) * 1.01")),
    "rows": (
        "rows",
        "rig = problem.rig\nu, v = (rb.Radial('equidistant', 100.0, c) for c in (150.0, 151.0))\n"
        "left, right = rb.Epipolar(u, u), rb.Epipolar(u, v)\n"
        "return rb.Rectification.from_targets(rig, left, right, (300, 300))",
    ),
    "random": ("repeatable", "options = options.model_copy(update={'scale': np.random.uniform(0.9, 1)})"),
    "raises": ("fit", "raise ValueError('no')"),
    "refuses": ("fit", "raise rb.Unsupported('never')"),
}


def test_a_control_may_have_any_rows(tmp_path: Path) -> None:
    file = Path(write_method(tmp_path, "control", FAULTS["rows"][1]))
    source = file.read_text()
    declared = source.replace('name = "control"', 'name = "control"\n    is_control = True')
    assert declared != source
    file.write_text(declared)
    assert failed(str(file)) == {}
    rows = [finding.detail for finding in findings(str(file)) if finding.check == "rows"]
    assert all("a control, whose rows are no epipolar planes" in detail for detail in rows)


@pytest.mark.parametrize("name", FAULTS)
def test_each_fault_fails_its_check_and_no_other(tmp_path: Path, name: str) -> None:
    check, fault = FAULTS[name]
    assert set(failed(write_method(tmp_path, name, fault))) - {"agreement"} == {
        check
    }  # which sees all of them
