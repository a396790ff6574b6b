"""What a run leaves behind is read back as it was, and anything else is refused in a line."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import rectbench as rb
from rectbench.experiments.execution.outcomes import Outcome
from rectbench.experiments.execution.running import Execution
from rectbench.experiments.planning import make_plan
from rectbench.runs.comparing import compare
from rectbench.runs.gating import accept, gate
from rectbench.runs.record import LEADING, PARQUET, RUN_FILE, RunRecord, read_record, table_of, write_run
from rectbench.runs.run import read_run
from tests.experiments.fakes import small_report

CLAIM = rb.Claim(
    name="Quick",
    says="It is quick.",
    statements=(rb.Statement(label="fit", metric="fit_s", method="abraham", below=1.0),),
    because={"held": "A formula is."},
)
PLAN = make_plan(small_report(methods=("abraham", "conventional"), seeds=(0, 1), claims=(CLAIM,)))
OUTCOMES = [Outcome(metrics={"log_distortion": 0.25, "fit_s": 0.01}, notes={"law": "x"})] * len(PLAN.tasks)
RECORD = RunRecord.of(Execution(PLAN, OUTCOMES, 2, 1, None), 1.234, "/reports/small.py")
STORED: dict[str, Any] = RECORD.model_dump(mode="json")
TABLE = table_of(PLAN, OUTCOMES)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    write_run(tmp_path / "run", TABLE, RECORD)
    return tmp_path / "run"


def refusal(folder: Path) -> str:
    """What is said of a run that cannot be read: one line that names the file."""
    with pytest.raises(rb.InvalidInput) as caught:
        read_run(folder)
    said = str(caught.value)
    assert "\n" not in said
    assert len(said) < 400
    assert str(folder) in said
    return said


def test_what_is_written_is_read_back(folder: Path) -> None:
    run = read_run(folder)
    assert run.record == RECORD
    assert [row.cell for row in run.results] == [task.cell for task in PLAN.tasks]
    assert run.results[0].metrics == {"log_distortion": 0.25, "fit_s": 0.01}
    assert run.results[0].notes == {"law": "x"}
    pd.testing.assert_frame_equal(run.table, TABLE)


@pytest.mark.parametrize("key", [key for key in STORED if key != "version"])
def test_a_key_that_is_missing_or_of_another_type_is_named(folder: Path, key: str) -> None:
    path = folder / RUN_FILE
    path.write_text(json.dumps({name: value for name, value in STORED.items() if name != key}))
    assert refusal(folder) == f"{path}: {key} is missing"
    for wrong in ([{"a": 1}], {"a": [1]}):
        path.write_text(json.dumps({**STORED, key: wrong}))
        assert f"{path}: {key}" in refusal(folder)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"extra": 1}, "extra is 1; Extra inputs are not permitted"),
        ({"version": 2}, "version is 2; expected 3"),
        ({"spec": {**STORED["spec"], "spp": 0}}, "spec.spp is 0; expected greater than or equal to 1"),
        ({"spec": {**STORED["spec"], "rigs": []}}, "rigs are missing"),
        ({"cells": [{**STORED["cells"][0], "group": 3}]}, "cells.0.group is 3; expected a valid string"),
    ],
)
def test_a_fault_is_told_with_its_key_its_value_and_what_was_expected(
    folder: Path, change: dict[str, Any], said: str
) -> None:
    (folder / RUN_FILE).write_text(json.dumps({**STORED, **change}))
    assert said in refusal(folder)


def test_a_run_of_before_there_were_versions_says_so(folder: Path) -> None:
    (folder / RUN_FILE).write_text(json.dumps({k: v for k, v in STORED.items() if k != "version"}))
    assert "as before there were versions; expected 3" in refusal(folder)


@pytest.mark.parametrize("text", ["", "{", "[]", "3", "null", "[" * 100_000, '{"version": NaN}', "\xff"])
def test_text_that_is_no_record_is_refused(folder: Path, text: str) -> None:
    (folder / RUN_FILE).write_bytes(text.encode("latin-1"))
    assert RUN_FILE in refusal(folder)


def test_a_cut_off_or_damaged_table_is_refused(folder: Path) -> None:
    path, rng = folder / PARQUET, np.random.default_rng(0)
    whole = path.read_bytes()
    for size in (0, 1, 8, len(whole) // 2, len(whole) - 1):
        path.write_bytes(whole[:size])
        assert PARQUET in refusal(folder)
    for _ in range(20):
        path.write_bytes(rng.bytes(len(whole)))
        assert PARQUET in refusal(folder)
    refused = []
    for _ in range(60):
        damaged = bytearray(whole)
        damaged[rng.integers(len(whole))] ^= 1 << rng.integers(8)
        path.write_bytes(bytes(damaged))
        try:
            assert read_run(folder).results  # what nothing shows leaves rows that are still rows
        except rb.InvalidInput as error:
            refused.append(str(error))
    assert len(refused) > 10
    assert not any("\n" in said for said in refused)


@pytest.mark.parametrize("column", LEADING)
def test_rows_without_an_identity_are_refused(folder: Path, column: str) -> None:
    TABLE.drop(columns=column).to_parquet(folder / PARQUET)
    assert refusal(folder) == f"{folder / PARQUET} lacks the column {column}"


def test_rows_without_optional_columns_are_read(folder: Path) -> None:
    TABLE[[*LEADING, "fit_s"]].to_parquet(folder / PARQUET)
    row = read_run(folder).results[0]
    assert (row.group, row.notes, row.metrics) == ("", {}, {"fit_s": 0.01})


@pytest.mark.parametrize(
    ("column", "value", "said"),
    [
        ("seed", "x", "row 1: seed is 'x'; expected a valid integer"),
        ("seed", None, "row 1: seed is missing"),
        ("scene", None, "row 1: scene is missing"),
        ("status", "fine", "row 1: status is 'fine'; expected 'ok'"),
        ("options", "[1]", "row 1: options is '[1]'; expected a JSON object"),
        ("options", "{", "row 1: options is '{'"),
        ("notes", "{", "row 1: notes is '{'"),
        ("fit_s", "slow", "row 1: fit_s is 'slow'; expected a valid number"),
        ("fit_s", [1.0, 2.0], "row 1: fit_s is array([1., 2.]); expected a valid number"),
        ("seed", pd.NA, "row 1: seed is missing"),
    ],
)
def test_an_entry_that_cannot_be_is_named_by_row_and_column(
    folder: Path, column: str, value: object, said: str
) -> None:
    TABLE.assign(**{column: [value] * len(TABLE)}).to_parquet(folder / PARQUET)
    assert said in refusal(folder)


def test_a_table_without_rows_is_refused(folder: Path) -> None:
    TABLE.iloc[:0].to_parquet(folder / PARQUET)
    assert refusal(folder).endswith("has no rows; expected one a cell")


@pytest.mark.parametrize(
    "damage",
    [
        lambda text: "",
        lambda text: text.replace("status", "state"),
        lambda text: text.replace("{}", "{"),
        lambda text: text.replace(",0,", ",x,"),
        lambda text: text.replace("ok", "fine"),
        lambda text: text.replace("0.25", "less"),
        lambda text: text.replace("abraham", ""),
        lambda text: '"' + text,
        lambda text: "\0\xff" * 50,
    ],
)
def test_accepted_numbers_that_cannot_be_read_are_refused(folder: Path, damage: Any) -> None:
    accepted = folder / "small.accepted.csv"
    accept(folder, accepted)
    assert gate(folder, accepted).exit_code == 0
    accepted.write_bytes(damage(accepted.read_text()).encode("latin-1"))
    with pytest.raises(rb.InvalidInput, match=r"accepted\.csv") as caught:
        gate(folder, accepted)
    assert "\n" not in str(caught.value)


def test_every_reader_refuses_alike(folder: Path, tmp_path: Path) -> None:
    (folder / RUN_FILE).write_text(json.dumps({**STORED, "jobs": "many"}))
    said = refusal(folder)
    for read in (read_record, lambda run: compare(run, run), lambda run: gate(run, tmp_path / "x.csv")):
        with pytest.raises(rb.InvalidInput, match="jobs is 'many'") as caught:
            read(folder)
        assert str(caught.value) == said
