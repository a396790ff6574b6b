from __future__ import annotations

import math
from collections.abc import Iterable
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rectbench as rb
from rectbench.cli.printing.design import percents
from rectbench.plugins.catalogue import known
from rectbench.runs.designing import design
from rectbench.runs.run import read_run
from rectbench.runs.units import by_rig
from rectbench.statistics.components import Spread
from rectbench.statistics.design import units_needed
from rectbench.statistics.power import resolved
from tests.conftest import Shell
from tests.reporting.runs import failed_row, make_row, save_run

RANKING = known().ranking.key
RIGS, SCENES, SEEDS = tuple(f"rig-{i}" for i in range(6)), ("street", "room"), (0, 1)


def rows(rigs: Iterable[str] = RIGS, metric: str = RANKING, pose: str = "exact") -> list[dict[str, Any]]:
    """Abraham's 30 % above ours, spreading over rigs; the conventional one twice Abraham's everywhere."""
    rng, made = np.random.default_rng(0), []
    for rig in rigs:
        of_rig, of_pair = rng.normal(0, 1.0), rng.normal(0, 0.1)
        for scene, seed in product(SCENES, SEEDS):
            ours = math.exp(of_rig)
            theirs = 1.3 * ours * math.exp(of_pair + rng.normal(0, 0.01))
            values = {"local-homography": ours, "abraham": theirs, "conventional": 2 * theirs}
            made += [make_row(scene, rig, pose, m, seed, **{metric: value}) for m, value in values.items()]
    return made


def ratios(
    given: list[dict[str, Any]], a: str, b: str, metric: str = RANKING
) -> dict[tuple[str, ...], float]:
    """The logarithms of a / b by rig, motion, scene, seed."""
    places = ("rig", "motion", "scene", "seed")
    logs = {
        m: {tuple(r[p] for p in places): math.log(r[metric]) for r in given if r["method"] == m}
        for m in (a, b)
    }
    return {place: logs[a][place] - logs[b][place] for place in logs[a]}


def test_a_row_says_what_the_statistics_say(tmp_path: Path) -> None:
    given = rows()
    table = design(save_run(tmp_path / "run", given), 0.02).table
    assert list(zip(table["a"], table["b"], strict=True)) == [
        ("local-homography", "abraham"),
        ("local-homography", "conventional"),
        ("abraham", "conventional"),
    ]
    first, spread = table.iloc[0], Spread.of(ratios(given, "local-homography", "abraham"))
    assert first["rigs"] == 6
    assert first["ratio"] == pytest.approx(math.exp(spread.mean))
    deviation = math.sqrt(spread.variance)
    assert first["resolves"] == pytest.approx(math.exp(resolved(deviation, 6, tests=3)))
    assert first["rigs_needed"] == units_needed(math.log(1.02), deviation, tests=3)
    assert first["rigs_needed"] > 6
    assert (first["motions"], first["scenes"], first["seeds"]) == (1, 2, 2)
    assert first["scenes_share"] + first["seeds_share"] < 0.05
    assert first[["scenes_needed", "seeds_needed"]].isna().all()


def test_methods_that_differ_by_the_same_everywhere_need_no_more(tmp_path: Path) -> None:
    last = design(save_run(tmp_path / "run", rows()), 0.02).table.iloc[2]
    assert last["ratio"] == pytest.approx(0.5)
    assert last["resolves"] == pytest.approx(1.0)
    assert (last["rigs_needed"], last["scenes_needed"]) == (3, 2)


def test_two_rigs_are_too_few_to_plan_from(tmp_path: Path) -> None:
    table = design(save_run(tmp_path / "run", rows(RIGS[:2])), 0.02).table
    assert set(table["reason"]) == {"2 rigs in common: too few to plan from"}
    assert table["rigs_needed"].isna().all()


def test_pairs_without_a_scene_need_none(
    tmp_path: Path, shell: Shell, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    save_run(Path("runs/quick"), [row | {"scene": "none"} for row in rows() if row["scene"] == "room"])
    table = rb.plan("quick").table
    assert (table["scenes"] == 0).all()
    assert table["scenes_needed"].isna().all()
    code, out, _ = shell("plan", "quick")
    assert code == 0
    assert "No scene is in these pairs" in out
    assert "or scenes" not in out


@pytest.mark.parametrize("matches", ["", "true + 0.1 px"])
def test_seeds_are_spoken_of_where_they_draw_something(planned: Path, shell: Shell, matches: str) -> None:
    one_seed = [row | {"matches": matches} for row in rows() if row["seed"] == 0]
    save_run(planned, one_seed)
    table = rb.plan("quick").table
    assert (table["seeds"] == (1 if matches else 0)).all()
    assert ("seed" in shell("plan", "quick")[1]) == bool(matches)
    save_run(planned, [row | {"pose": "perturbed"} for row in one_seed])
    assert "One seed each: what more seeds would do is unknown." in shell("plan", "quick")[1]


def test_what_is_told_already_needs_nothing_more(planned: Path, shell: Shell) -> None:
    out = shell("plan", "quick", "--detect", "100%")[1]
    assert "This run tells 100 % between any two of them already." in out
    assert "More" not in out
    assert "rigs only" not in out


def test_what_seeds_cannot_tell_rigs_can(planned: Path, shell: Shell) -> None:
    out = shell("plan", "quick")[1]
    assert "rigs only" in out
    assert "Rigs only: on as many rigs as these no number of scenes or seeds tells 2 %." in out
    assert "no number is" not in out


def test_scenes_that_differ_are_worth_more_of_them(planned: Path, shell: Shell) -> None:
    uneven = [row | {RANKING: row[RANKING] * _uneven(row)} for row in rows()]
    save_run(planned, uneven)
    out = shell("plan", "quick")[1]
    assert "of the variance between rigs: more would help" in out
    assert "would help" not in shell("plan", "quick", "--detect", "5000%")[1]


def _uneven(row: dict[str, Any]) -> float:
    """Abraham's luck with each scene of each rig."""
    luck = {"street": 1.7, "room": 0.7} if int(row["rig"][-1]) % 2 else {"street": 0.7, "room": 1.7}
    return luck[row["scene"]] if row["method"] == "abraham" else 1.0


def test_the_list_of_metrics_has_what_a_plan_can_be_made_for(shell: Shell) -> None:
    out = shell("list", "metrics")[1]
    assert all(key in out for key in (RANKING, "row_error_mean_px", "reconstruction_density"))


def test_no_difference_has_no_sign() -> None:
    assert percents(1 - 1e-12, 1.0, 1 + 1e-9) == ("0.0 %", "0.0 %", "0.0 %")
    assert percents(1 - 2e-4) == ("-0.02 %",)
    assert percents(0.9, 3.0) == ("× 0.9", "× 3")


def test_the_verb_says_where_there_are_too_few_rigs(
    tmp_path: Path, shell: Shell, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    save_run(Path("runs/quick"), rows(RIGS[:2]))
    code, out, _ = shell("plan", "quick")
    assert code == 3
    assert out.count("2 rigs in common: too few to plan from") == 3


def test_methods_are_compared_on_the_rigs_that_both_have(tmp_path: Path) -> None:
    given = [r for r in rows() if not (r["method"] == "abraham" and r["rig"] in RIGS[:2])]
    given += [failed_row(scene, RIGS[0], "exact", "abraham") for scene in SCENES]
    table = design(save_run(tmp_path / "run", given), 0.02).table
    common = dict(zip(zip(table["a"], table["b"], strict=True), table["rigs"], strict=True))
    assert common.pop(("local-homography", "conventional")) == 6
    assert set(common.values()) == {4}


def test_row_errors_are_compared_where_the_pose_is_off(tmp_path: Path) -> None:
    metric = "row_error_mean_px"
    given = [*rows(), *rows(metric=metric, pose="perturbed")]
    run = save_run(tmp_path / "run", given)
    assert set(design(run, 0.1, metric).table["pose"]) == {"perturbed"}
    assert set(design(run, 0.1).table["pose"]) == {"exact"}


def test_rounding_is_no_difference(tmp_path: Path) -> None:
    metric, given = "row_error_mean_px", rows()
    for row in given:
        row[metric] = 1e-13 if row["method"] == "abraham" else 7e-13
    table = design(save_run(tmp_path / "run", given), 0.1, metric).table
    assert set(table["ratio"]) == {1.0}


def test_what_cannot_be_planned_is_said_in_one_line(tmp_path: Path) -> None:
    run = save_run(tmp_path / "run", rows())
    with pytest.raises(
        rb.UnknownName, match="unknown metric 'row_error_mean'; did you mean row_error_mean_px"
    ):
        design(run, 0.02, "row_error_mean")
    with pytest.raises(rb.InvalidInput, match="is no run's folder"):
        design(tmp_path, 0.02)
    negative = save_run(tmp_path / "negative", [row | {RANKING: -1.0} for row in rows()])
    with pytest.raises(rb.InvalidInput, match=f"{RANKING} is -1 somewhere; expected numbers from 0 on"):
        design(negative, 0.02)
    alone = save_run(tmp_path / "alone", [row for row in rows() if row["method"] == "abraham"])
    with pytest.raises(rb.InvalidInput, match="of one method alone; expected two"):
        design(alone, 0.02)


def test_a_rig_counts_for_a_method_that_was_measured_wherever_any_was(tmp_path: Path) -> None:
    given = rows(RIGS[:3])
    given[0] = failed_row("street", RIGS[0], "exact", "local-homography")
    run = read_run(save_run(tmp_path / "run", given))
    values = by_rig(run.results, run.catalogue.ranking)
    assert list(values["local-homography"]) == list(RIGS[1:3])
    assert list(values["abraham"]) == list(RIGS[:3])


@pytest.fixture
def planned(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return save_run(Path("runs/quick"), rows())


def test_the_verb_prints_what_python_gives(planned: Path, shell: Shell) -> None:
    code, out, _ = shell("plan", "quick", "--detect", "5 %")
    assert code == 0
    found = rb.plan("quick", detect=0.05)
    assert found.detect == 0.05
    for row in found.table.to_dict("records"):
        assert f" {percents(row['ratio'])[0]} " in out
        assert f" {row['rigs_needed']} " in out
    assert "rigs for 5 %" in out
    assert "More scenes would hardly help" in out
    assert rb.plan("quick", detect="5%", run=planned).table.equals(found.table)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (
            "plan quick --run elsewhere",
            "elsewhere holds no run yet; expected one, which `rectbench run quick",
        ),
        ("plan quik", "unknown report 'quik'; did you mean quick"),
        ("plan paper --run runs/quick", "runs/quick is a run of quick; expected one of paper"),
        ("plan quick --metric rows", "unknown metric 'rows'"),
        ("plan quick --metric row_eror_mean_px", "did you mean row_error_mean_px"),
        (
            "plan quick --metric row_error",
            "metric is row_error, of several numbers; expected one of row_error_",
        ),
        (
            "plan quick --metric depth_error_p95",
            "runs/quick has no depth_error_p95, which its report does not",
        ),
        ("plan quick --detect 0", "detect is '0'; expected a percentage above 0 such as 2%"),
        ("plan quick --detect -2%", "detect is '-2%'; expected a percentage above 0"),
        ("plan quick --detect 2", "detect is '2'; expected a percentage above 0"),
        ("plan quick --detect much", "detect is 'much'; expected a percentage above 0"),
        ("plan quick --detect nan%", "detect is 'nan%'; expected a percentage above 0"),
    ],
)
def test_the_verb_refuses_in_one_line(planned: Path, shell: Shell, words: str, message: str) -> None:
    code, out, err = shell(*words.split())
    assert (code, out) == (2, "")
    assert message in err
    assert err.count("\n") == 1


@pytest.mark.parametrize(
    ("given", "share"), [("2%", 0.02), ("2 %", 0.02), ("0.02", 0.02), (0.5, 0.5), ("150%", 1.5)]
)
def test_a_percentage_is_written_as_people_do(planned: Path, given: str | float, share: float) -> None:
    assert rb.plan("quick", detect=given).detect == pytest.approx(share)
