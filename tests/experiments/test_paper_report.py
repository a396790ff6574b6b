"""The paper's report measures what its claims speak of, each on lenses enough for an interval."""

from __future__ import annotations

import pytest

import rectbench as rb
from rectbench.experiments.planning import make_plan
from rectbench.experiments.spec import REPORTS
from rectbench.metrics.scoring import metrics_of
from rectbench.registry import registry
from rectbench.statistics.intervals import LEAST_UNITS


@pytest.fixture(scope="module")
def paper() -> rb.Report:
    return registry(REPORTS).get("paper").value


def test_each_statement_s_column_is_measured_in_its_part(paper: rb.Report) -> None:
    columns = {
        part.name: {c.key for plugin in metrics_of(part.metrics).values() for c in plugin.value.columns}
        for part in paper.parts
    }
    for statement in (s for claim in paper.claims for s in claim.statements):
        for column in filter(None, (statement.metric, statement.over)):
            for group, _ in statement.speaks_of:
                assert column in columns[group], (statement.label, column)


def test_what_a_statement_compares_is_one_set_of_options(paper: rb.Report) -> None:
    parts = {part.name: part for part in paper.parts}
    for statement in (s for claim in paper.claims for s in claim.statements if s.against):
        _, (group, rival) = statement.speaks_of
        sets = parts[group].options.get(rival, ({},))
        fitting = [given for given in sets if statement.against_options.items() <= given.items()]
        assert len(fitting) == 1, statement.label


def test_each_claim_is_judged_on_lenses_enough_for_a_verdict(paper: rb.Report) -> None:
    rigs = {part.name: {rig for _, rig, _ in part.pairs} for part in paper.parts}
    for statement in (s for claim in paper.claims for s in claim.statements if s.judges):
        assert len(rigs[statement.group]) >= max(LEAST_UNITS, statement.of or 0), statement.label


def test_it_can_be_planned(paper: rb.Report) -> None:
    plan = make_plan(paper)
    assert plan.is_whole
    assert len({task.group for task in plan.tasks}) == len(paper.groups)
