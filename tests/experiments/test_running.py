"""What a run promises: every cell a row, whatever its plugin does, and nothing finished is lost."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

import rectbench as rb
from rectbench.plugins.catalogue import known
from rectbench.runs.making import run
from rectbench.runs.run import read_run
from rectbench.store.store import STORE_VARIABLE, Store
from tests.experiments.fakes import (
    ASSERT_ONE_THREAD,
    FIELDS,
    small_report,
    write_method,
    write_report_file,
    write_scene,
)

TIMES = ["fit_s", "maps_s", "warp_s"]

MISBEHAVIOUR = {
    "surrogate": "raise ValueError('half a \\ud800 letter')",
    "subclass": "class Odd(rb.Rectification): pass\n"
    "rect = rb.rectify(problem.rig, 'abraham')\n"
    "return Odd(rect.rig, rect.left, rect.right, rect.size)",
    "exits": "os._exit(7)",
    "killed": "os.kill(os.getpid(), signal.SIGKILL)",
    "leaves": "sys.exit(3)",
    "interrupts": "raise KeyboardInterrupt",
    "hungry": "np.ones(2**31).sum()",
    "raises": "raise ValueError('first line\\nsecond line')",
    "refuses": "raise rb.Unsupported('an epipole is in the way')",
    "lacks": "raise rb.Unavailable('a licence is missing')",
    "text": "return 'no rectification'",
    "nothing": "return None",
    "nan": "class Blind(rb.Warp):\n    def forward(self, px): return np.full(np.shape(px), np.nan)\n"
    "rig, target = problem.rig, rb.Perspective(np.eye(3))\n"
    "sides = [Blind(camera, np.eye(3), target) for camera in (rig.left, rig.right)]\n"
    "return rb.Rectification(rig, *sides, (10, 10))",
    "huge": "t = rb.Perspective(np.eye(3))\n"
    "return rb.Rectification.from_targets(problem.rig, t, t, (10**6, 10))",
    "foreign": "rig = rb.load_rig('t265'); t = rb.Perspective(np.eye(3))\n"
    "return rb.Rectification.from_targets(rig, t, t, (10, 10))",
}


@pytest.fixture(scope="module")
def misbehaved(tmp_path_factory: pytest.TempPathFactory) -> pd.DataFrame:
    """One run of sound methods among all that misbehave, by method."""
    folder = tmp_path_factory.mktemp("misbehaved")
    bad = [write_method(folder, name, what) for name, what in MISBEHAVIOUR.items()]
    good = [write_method(folder, f"good{i}") for i in range(2)]
    report = small_report(methods=(good[0], *bad, good[1]), memory_gib=2.0)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(STORE_VARIABLE, str(folder / "store"))
        table = run(report, folder / "run", jobs=2)
    return table.set_index("method", drop=False)


@pytest.mark.parametrize(
    ("method", "status", "reason"),
    [
        ("exits", "crash", "ended with exit code 7"),
        ("killed", "crash", "killed by SIGKILL"),
        ("leaves", "error", "SystemExit: 3"),
        ("interrupts", "error", "KeyboardInterrupt"),
        ("hungry", "oom", "Unable to allocate"),
        ("raises", "error", r"ValueError: first line second line \(raises.py:\d+\)"),
        ("refuses", "unsupported", "an epipole is in the way"),
        ("lacks", "unavailable", "a licence is missing"),
        ("text", "invalid", "text returned str; expected a Rectification"),
        ("nothing", "invalid", "nothing returned NoneType; expected a Rectification"),
        ("surrogate", "error", r"ValueError: half a \? letter"),
        ("subclass", "invalid", "subclass returned Odd; expected a Rectification itself"),
        ("nan", "invalid", "left.forward gives no finite pixel"),
        ("huge", "invalid", "1000000x10"),
        ("foreign", "invalid", "starts from another camera"),
        ("good0", "ok", ""),
        ("good1", "ok", ""),
    ],
)
def test_each_cell_says_how_it_ended(misbehaved: pd.DataFrame, method: str, status: str, reason: str) -> None:
    row = misbehaved.loc[method]
    assert row["status"] == status, row["reason"]
    assert pd.Series([row["reason"]]).str.contains(reason).all(), row["reason"]
    assert "\n" not in row["reason"]
    assert pd.isna(row["log_distortion"]) == (status != "ok")


def test_no_cell_is_dropped_and_the_order_is_the_reports(misbehaved: pd.DataFrame) -> None:
    assert list(misbehaved.index) == ["good0", *MISBEHAVIOUR, "good1"]


def test_a_cell_that_hangs_is_stopped_and_the_next_one_runs(tmp_path: Path) -> None:
    awake = tmp_path / "awake"
    sleeps = f"""
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
        time.sleep(30)
        Path({str(awake)!r}).touch()
    """
    methods = (
        write_method(tmp_path, "sleeps", sleeps),
        write_method(tmp_path, "spins", "while True: pass"),
    )
    table = run(small_report(methods=methods, timeout_s=2.0), jobs=1)
    assert list(table["status"]) == ["timeout", "timeout"]
    assert list(table["reason"]) == ["stopped after 2 s"] * 2
    assert not awake.exists()


def test_a_scene_that_fails_fails_its_cells_and_no_others(tmp_path: Path) -> None:
    scenes = (
        write_scene(tmp_path, "broken", "raise ValueError('no bricks')"),
        write_scene(tmp_path, "odd", "return 'a wall'"),
        write_scene(tmp_path, "wall"),
    )
    report = small_report(scenes=scenes, metrics=("geometry", "row_error"), methods=("abraham", "hartley"))
    table = run(report, jobs=2)
    assert list(table["status"]) == ["error", "error", "invalid", "invalid", "ok", "ok"]
    assert table["reason"][0].startswith("rendering the pair: ValueError: no bricks")
    assert "odd returned str; expected a World" in table["reason"][2]
    calibrated = table.iloc[4]
    assert calibrated["row_error_max_px"] < 1e-6
    assert calibrated["row_error_matches"] > 100


@pytest.fixture(scope="module")
def report_of_four(tmp_path_factory: pytest.TempPathFactory) -> rb.Report:
    wall = write_scene(tmp_path_factory.mktemp("scenes"), "wall")
    return small_report(
        scenes=(wall,),
        rigs=("t265", "sony-as200v"),
        motions=("sideways",),
        poses=("perturbed",),
        methods=("hartley", "abraham"),
        metrics=("geometry", "row_error", "row_error_features"),
        matches=("true + 0.5 px",),
    )


def test_the_rows_do_not_depend_on_the_number_of_jobs(report_of_four: rb.Report, tmp_path: Path) -> None:
    tables = [run(report_of_four, tmp_path / f"run{jobs}", jobs=jobs, fresh=True) for jobs in (1, 3)]
    pd.testing.assert_frame_equal(*tables, check_exact=True)
    assert (tables[0]["status"] == "ok").all()
    assert tables[0]["row_error_mean_px"].between(1e-3, 10).all()
    assert tables[0]["row_error_features_mean_px"].notna().all()


@pytest.mark.parametrize("jobs", [1, 2])
def test_blas_and_openmp_add_up_with_one_thread_for_any_number_of_jobs(tmp_path: Path, jobs: int) -> None:
    method = write_method(tmp_path, "one_thread", ASSERT_ONE_THREAD)
    assert list(run(small_report(methods=(method,)), jobs=jobs)["reason"]) == [""]


def test_cells_run_while_other_pairs_are_still_rendered(tmp_path: Path) -> None:
    ran = tmp_path / "ran"
    waits = f"import time, pathlib\nwhile not pathlib.Path({str(ran)!r}).exists(): time.sleep(0.05)"
    scenes = (write_scene(tmp_path, "slow", waits), write_scene(tmp_path, "quick"))
    method = write_method(tmp_path, "told", f"Path({str(ran)!r}).touch()")
    fields = {"metrics": ("geometry", "row_error"), "methods": (method,), "render_timeout_s": 60.0}
    table = run(small_report(scenes=scenes, **fields), jobs=2)
    assert list(table["status"]) == ["ok", "ok"], list(table["reason"])


def test_what_plugins_warn_of_does_not_reach_the_terminal(tmp_path: Path) -> None:
    warn = "import warnings; warnings.warn('a plugin warns'); np.mean([])"
    methods = (write_method(tmp_path, "warns", warn), "abraham")
    figure = tmp_path / "figure.py"
    figure.write_text(
        "import matplotlib.figure, numpy as np, rectbench as rb\n"
        "class Warns(rb.Figure):\n"
        "    'A figure.'\n"
        "    name, topic = 'warns', 'Charts'\n"
        "    def drawings(self, given):\n"
        "        np.mean([])\n"
        "        def draw():\n"
        "            np.mean([])\n"
        "            return matplotlib.figure.Figure()\n"
        "        yield rb.Drawing('warns', 'Warns', '', 0, draw)\n"
    )
    scene = write_scene(tmp_path, "wall", warn)
    figures = ("bars", "coverage-curve", "maps", str(figure))
    fields = {
        "scenes": (scene,),
        "figures": figures,
        "metrics": ("geometry", "row_error"),
        "methods": methods,
    }
    report = write_report_file(tmp_path, **fields)
    command = [
        sys.executable,
        "-m",
        "rectbench",
        "run",
        report,
        "--out",
        str(tmp_path / "run"),
        "--jobs",
        "1",
    ]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stderr == ""


def test_a_run_folder_holds_the_rows_and_the_plan(report_of_four: rb.Report, tmp_path: Path) -> None:
    table = run(report_of_four, tmp_path / "run", jobs=2)
    pd.testing.assert_frame_equal(pd.read_parquet(tmp_path / "run" / "results.parquet"), table)
    pd.testing.assert_frame_equal(read_run(tmp_path / "run").table, table)
    written = pd.read_csv(tmp_path / "run" / "results.csv")
    assert list(written.columns) == list(table.columns)
    identity = ["report", "scene", "rig", "motion", "pose", "matches", "method", "options", "seed"]
    assert list(table.columns[:11]) == [*identity, "status", "reason"]
    assert set(known().promised) <= set(table.columns)
    facts = json.loads((tmp_path / "run" / "run.json").read_text())
    assert facts["report"] == "small"
    assert len(facts["cells"]) == len(table) == 4
    for name in ("versions", "llvm", "cpu", "git_revision", "seeds", "python", "wall_s", "spec"):
        assert name in facts


def test_a_second_run_finds_everything(tmp_path: Path) -> None:
    calls = tmp_path / "calls"
    counted = write_method(tmp_path, "counted", f"Path({str(calls)!r}).open('a').write('x')")
    report = small_report(methods=(counted,), metrics=("geometry", "timing"))
    first = run(report, jobs=1)
    made = calls.read_text()
    second = run(report, jobs=1)
    assert calls.read_text() == made
    pd.testing.assert_frame_equal(first, second)  # the times too: nothing was measured again
    run(report, jobs=1, fresh=True)
    assert len(calls.read_text()) > len(made)


def test_an_edited_method_runs_again_and_the_others_do_not(tmp_path: Path) -> None:
    calls = tmp_path / "calls"
    count = f"Path({str(calls)!r}).open('a').write(self.name[0])"
    methods = (write_method(tmp_path, "a", count), write_method(tmp_path, "b", count))
    run(small_report(methods=methods), jobs=1)
    write_method(tmp_path, "b", count + "; x = 1")
    run(small_report(methods=methods), jobs=1)
    assert sorted(calls.read_text()) == ["a", "b", "b"]


def test_failures_that_may_be_the_machines_are_tried_again(tmp_path: Path) -> None:
    flag = tmp_path / "fixed"
    method = write_method(tmp_path, "moody", f"if not Path({str(flag)!r}).exists(): os._exit(1)")
    assert list(run(small_report(methods=(method,)), jobs=1)["status"]) == ["crash"]
    flag.touch()
    assert list(run(small_report(methods=(method,)), jobs=1)["status"]) == ["ok"]


def test_a_damaged_row_is_made_again(store: Store) -> None:
    first = run(small_report(), jobs=1)
    (row,) = store.root.glob("cells/??/*/row.json")
    row.write_text(row.read_text().replace('"ok"', '"no"'))
    pd.testing.assert_frame_equal(run(small_report(), jobs=1), first)


def _until(condition: Callable[[], Any], seconds: float = 60) -> None:
    deadline = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < deadline, "waited in vain"
        time.sleep(0.05)


def _gone(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().split()[2] == "Z"
    except FileNotFoundError:
        return True


@pytest.mark.parametrize("stop", [signal.SIGKILL, signal.SIGINT])
def test_a_run_cut_off_in_the_middle_loses_nothing_and_leaves_no_process(
    tmp_path: Path, store: Store, stop: signal.Signals
) -> None:
    calls, pid, go = tmp_path / "calls", tmp_path / "pid", tmp_path / "go"
    first = write_method(tmp_path, "first", f"Path({str(calls)!r}).open('a').write('x')")
    waits = f"""
        Path({str(pid)!r}).write_text(str(os.getpid()))
        while not Path({str(go)!r}).exists(): time.sleep(0.1)
    """
    second = write_method(tmp_path, "second", waits)
    fields = {**FIELDS, "methods": (first, second)}
    # At the top level of a script, without a guard: workers must not run it again.
    script = tmp_path / "script.py"
    script.write_text(
        f"import rectbench as rb\nfrom rectbench.runs.making import run\n"
        f"run(rb.Report(**{fields!r}), {str(tmp_path / 'run')!r}, jobs=1)\n"
    )
    process = subprocess.Popen(
        [sys.executable, script],
        env=os.environ,
        stderr=subprocess.PIPE,
        text=True,
        # A shell's background job ignores Ctrl-C, and would hand that on.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    _until(lambda: pid.exists() and pid.read_text())
    worker = int(pid.read_text())
    process.send_signal(stop)
    _, errors = process.communicate(timeout=30)
    assert process.returncode != 0
    _until(lambda: _gone(worker), 15)
    assert not (tmp_path / "run").exists()
    if stop == signal.SIGINT:
        assert "1 of 2 cells are kept" in errors
    go.touch()
    table = run(rb.Report(**fields), tmp_path / "run", jobs=1)
    assert list(table["status"]) == ["ok", "ok"]
    assert calls.read_text() == "x"


def test_a_report_is_one_of_a_kind_and_jobs_are_whole_numbers() -> None:
    for wrong in (0, -1, 1.5, True):
        with pytest.raises(rb.InvalidInput, match="jobs is"):
            run(small_report(), jobs=wrong)  # type: ignore[arg-type]
    with pytest.raises(rb.UnknownName, match="did you mean quick"):
        run("quik")
    assert not Path("runs").exists()


def test_an_output_that_cannot_be_written_is_said_before_anything_runs(tmp_path: Path, store: Store) -> None:
    (tmp_path / "file").write_text("in the way")
    for out in (tmp_path / "file", tmp_path / "file" / "run"):
        with pytest.raises(rb.InvalidInput, match="cannot be written; expected a folder"):
            run(small_report(), out)
    assert not store.root.exists()


def test_a_store_that_cannot_be_written_is_said_in_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv(STORE_VARIABLE, str(tmp_path / "file" / "store"))
    with pytest.raises(rb.Unavailable, match="cannot be written"):
        run(small_report(), jobs=1)
