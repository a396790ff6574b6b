"""The same cells on a dask cluster on this machine."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pandas as pd
import pytest

import rectbench as rb
from rectbench.runs.making import run
from rectbench.runs.record import CSV, PARQUET
from tests.experiments.fakes import ASSERT_ONE_THREAD, small_report, write_method, write_scene

distributed = pytest.importorskip("distributed", reason="the extra rectbench[dask] is not installed")


@pytest.fixture
def address() -> Iterator[str]:
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=2, processes=False, dashboard_address=None
    ) as cluster:
        yield cluster.scheduler_address


def test_the_rows_are_the_same_and_a_crash_costs_its_cell_alone(tmp_path: Path, address: str) -> None:
    one_thread = write_method(tmp_path, "one_thread", ASSERT_ONE_THREAD)
    methods = ("abraham", write_method(tmp_path, "exits", "os._exit(7)"), one_thread)
    report = small_report(methods=methods)
    on_cluster = run(report, dask=address)
    assert list(on_cluster["status"]) == ["ok", "crash", "ok"], list(on_cluster["reason"])
    assert "7" in on_cluster["reason"][1]
    # What the cluster finished is in the store here: only the crashed cell runs again.
    pd.testing.assert_frame_equal(
        run(report, jobs=1).drop(columns="reason"), on_cluster.drop(columns="reason")
    )
    local = run(report, jobs=1, fresh=True)
    pd.testing.assert_frame_equal(local.drop(columns="reason"), on_cluster.drop(columns="reason"))


def test_results_are_the_same_bytes_for_any_number_of_jobs_and_on_a_cluster(
    tmp_path: Path, address: str
) -> None:
    common = {"motions": ("sideways",), "methods": ("abraham", "local-homography"), "seeds": (0,)}
    lenses = rb.Group(
        name="lenses", rigs=("t265", "tumvi"), poses=("exact",), metrics=("geometry", "energy"), **common
    )
    dense = rb.Group(
        name="dense",
        scenes=(write_scene(tmp_path, "wall"),),
        rigs=("t265",),
        metrics=("row_error", "row_error_features", "reconstruction"),
        image_width=64,
        **common,
    )
    report = rb.Report(
        name="bytes", title="B", description="B.", groups=(lenses, dense), poses=("perturbed",), spp=4
    )
    ways = {"one": {"jobs": 1}, "two": {"jobs": 2}, "dask": {"dask": address}}
    for name, way in ways.items():
        table = run(report, tmp_path / name, fresh=True, **way)
        assert list(table["status"]) == ["ok"] * 6, list(table["reason"])
        assert table["log_distortion_95"].notna().sum() == 4
        assert table["reconstruction_density"].notna().sum() == 2
    for file in (PARQUET, CSV):
        one, two, dask = ((tmp_path / name / file).read_bytes() for name in ways)
        assert one == two
        assert one == dask


def test_a_scheduler_that_does_not_answer_is_said_in_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("rectbench.experiments.execution.cluster.CONNECT_TIMEOUT_S", 1)
    with pytest.raises(rb.Unavailable, match=r"no dask scheduler answers at tcp://127\.0\.0\.1:9"):
        run(small_report(), dask="tcp://127.0.0.1:9")
