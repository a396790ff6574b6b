"""A report of several parts: fisheye pairs, a study of random starts, times, and claims about them."""

from __future__ import annotations

import csv
import io
import json
import re
from collections.abc import Callable
from itertools import product
from pathlib import Path
from typing import Any

import pytest

from rectbench.reporting.charts.starts import start_study
from rectbench.reporting.figures import EXTENSIONS
from rectbench.reporting.names import pair_labels
from rectbench.reporting.report import write_report
from rectbench.reporting.tables.part_tables import all_tables, pose_table, starts_table, timing_table
from rectbench.reporting.tables.table import Table, to_csv, to_latex
from rectbench.runs.run import read_run
from tests.reporting.runs import failed_row, fake_sources, make_row, save_run
from tests.reporting.test_report import Page

WriteRun = Callable[..., Path]
METHODS = ("conventional", "abraham", "local-homography")
OURS = "local-homography"
DEPTH = {"reconstruction_density": 0.9, "reconstruction_completeness": 0.8, "dense_bad_2px": 0.2}
POSE = {"pose_rotation_error_deg": 0.02, "pose_rotation_sigma_deg": 0.01, "pose_inliers": 300.0}
TIMES = {"pose_s": 0.9, "fit_s": 0.02, "warp_s": 0.06, "total_s": 0.98}
KINDS = ["bars", "coverage-curve", "pairs", "maps", "energy", "squares", "clouds"]
CLAIM = {
    "name": "Least distortion",
    "says": "It is the least of all, by ±0 %.",
    "statements": [
        {
            "label": "rigs where it is least",
            "group": "fisheye",
            "metric": "distortion_native",
            "method": OURS,
            "measure": "count",
            "rivals": ["abraham"],
            "above": 1,
            "of": 1,
        }
    ],
    "because": {"held": "It is fitted to it."},
}
SECTIONS = ("part-fisheye", "part-starts", "part-timing")
SPEC = {
    "groups": [
        {"name": "fisheye", "title": "Fisheye pairs", "figures": KINDS},
        {"name": "starts", "title": "Random starts", "figures": ["starts"]},
        {"name": "timing", "title": "Time", "figures": ["timing"]},
    ],
    "stated_seconds": {"pose": 6.0, "fit": 3.0, "warp": 6.0},
    "claims": [CLAIM],
    "source_parts": [{"name": "Its data", "status": "impossible", "why": "They are not public."}],
}


def grouped(group: str, row: dict[str, Any], **changes: Any) -> dict[str, Any]:
    return row | {"group": group, "report": "paper"} | changes


def start_row(scene: str, draw: int, ratio: float, seed: int = 0) -> dict[str, Any]:
    default = make_row(scene, "t265", "estimated", OURS, seed)
    identity = {k: v for k, v in default.items() if isinstance(v, str | int) and k != "notes"}
    options = json.dumps({"draw": draw, "start": "random"})
    energy = ratio * default["distortion_native"]
    return grouped(
        "starts", identity, options=options, distortion_native=energy, distortion_native_grid=energy
    )


def paper_rows() -> list[dict[str, Any]]:
    """Two pairs of one rig, two seeds; of each pair's random starts one collapses and one fails."""
    seen = DEPTH | POSE | {"row_error_features_mean_px": 0.3, "energy_convex_share": 0.97}
    rows = []
    for scene, seed, method in product(("street", "room"), (0, 1), METHODS):
        row = make_row(scene, "t265", "estimated", method, seed)
        rows.append(grouped("fisheye", row, **seen, distortion_native_grid=row["distortion_native"]))
    for scene in ("street", "room"):
        rows += [start_row(scene, draw, ratio) for draw, ratio in enumerate((1.0, 1.0 + 3e-9, 1.004, 9.0))]
        failed = failed_row(scene, "t265", "estimated", OURS, reason="fell")
        rows.append(grouped("starts", failed, options='{"draw": 4, "start": "random"}'))
    timing = [make_row("street", "t265", "estimated", m) for m in METHODS]
    kept = ("scene", "rig", "motion", "pose", "method", "options", "seed", "status", "reason")
    return rows + [grouped("timing", {k: r[k] for k in kept}, motion="fast", **TIMES) for r in timing]


@pytest.fixture(scope="module")
def reported(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One whole report of parts, looked at by many tests."""
    folder = save_run(tmp_path_factory.mktemp("parts"), paper_rows(), spec=SPEC)
    write_report(folder, sources=fake_sources(96))
    return folder


def records(table: Table) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(to_csv(table))))


def test_every_kind_of_figure_is_there_once_under_its_part_s_name(reported: Path) -> None:
    stems = {f"{kind}-fisheye" for kind in ("row-error", "distortion", "distortion-coverage")}
    stems |= {f"{k}-fisheye-t265" for k in ("rectified", "distortion-map", "squares", "energy", "clouds")}
    stems |= {"starts", "timing"}
    found = {path.name for path in (reported / "figures").iterdir()} - {"manifest.json"}
    assert found == {f"{stem}.{extension}" for stem in stems for extension in EXTENSIONS}


def test_every_table_is_there_once_under_its_part_s_name(reported: Path) -> None:
    stems = {"claims", "claims-measured", "claims-by-rig-least-distortion", "source-parts", "failures"}
    stems |= {"starts", "timing", "pair-timing-street-t265"}
    stems |= {
        f"{k}-fisheye"
        for k in ("log-distortion", "distortion", "row-error", "coverage", "pose", "reconstruction", "energy")
    }
    stems |= {"main-fisheye-estimated", "pair-fisheye-street-t265", "pair-fisheye-room-t265"}
    assert {path.stem for path in (reported / "tables").iterdir()} == stems


def test_the_page_has_a_section_a_part_and_its_verdicts_before_them(reported: Path) -> None:
    text = (reported / "index.html").read_text()
    places = [text.index(f'<section id="{name}">') for name in ("claims", *SECTIONS)]
    assert places == sorted(places)
    assert "could not be drawn" not in text
    inside = re.findall(r'id="([^"]+)"', text)
    assert len(set(inside)) == len(inside)
    for target in Page(reported / "index.html").targets:
        assert target[1:] in inside if target.startswith("#") else (reported / target).is_file(), target
    words = " ".join(Page(reported / "index.html").words)
    assert "It is fitted to it." in words
    assert "draw=3" not in words  # a random start is no method


def test_a_start_is_measured_against_the_default_one_of_another_part(write_run: WriteRun) -> None:
    run = read_run(write_run(paper_rows(), spec=SPEC))
    street, room = start_study(run.part("starts"), run)
    assert street.label == "street\nt265"
    assert street.ratios == pytest.approx((1.0, 1.0, 1.004, 9.0))
    assert (street.count, street.same, street.failed) == (5, 3, 1)
    row = records(starts_table(run.part("starts"), (street, room)))[0]
    assert (row["starts"], row["same"], row["failed"]) == ("5", "3", "1")
    assert float(row["excess_largest"]) == pytest.approx(8.0)


def test_a_start_without_a_default_one_is_no_part_of_the_study(write_run: WriteRun) -> None:
    run = read_run(write_run([start_row("street", draw, 1.0) for draw in range(3)], spec=SPEC))
    assert start_study(run.part("starts"), run) == ()


def test_options_of_one_part_do_not_rename_a_method_in_another(write_run: WriteRun) -> None:
    run = read_run(write_run(paper_rows(), spec=SPEC))
    assert run.part("fisheye").methods == METHODS


def test_variants_of_a_start_stay_methods_where_no_study_is_asked_for(write_run: WriteRun) -> None:
    rows = [row | {"group": ""} for row in (start_row("street", draw, 1.0) for draw in range(2))]
    names = {table.name for table in all_tables(read_run(write_run(rows)))}
    assert names == {"main-estimated", "distortion", "pair-street-t265"}


def test_a_pose_that_methods_share_is_counted_once(write_run: WriteRun) -> None:
    rows = [
        r | {"pose_rotation_error_deg": 0.08} if (r["scene"], r["seed"]) == ("street", 0) else r
        for r in paper_rows()
    ]
    run = read_run(write_run(rows))
    street, room, median = records(pose_table(run.part("fisheye")))
    assert (street["poses"], room["poses"], median["poses"]) == ("2", "2", "4")
    assert float(street["pose_rotation_error_deg"]) == pytest.approx(0.05)
    assert float(median["pose_rotation_error_deg"]) == pytest.approx(0.02)


def test_stated_times_stand_beside_the_measured_ones(write_run: WriteRun) -> None:
    rows = records(timing_table(read_run(write_run(paper_rows(), spec=SPEC)).part("timing")))
    assert [row["method"] for row in rows] == [*METHODS, "as stated"]
    assert [float(rows[-1][key]) for key in TIMES] == [6.0, 3.0, 6.0, 15.0]
    assert [float(rows[0][key]) for key in TIMES] == pytest.approx(list(TIMES.values()))


def test_a_claim_has_its_verdict_and_its_measurement(reported: Path) -> None:
    verdict = next(csv.DictReader((reported / "tables/claims.csv").open()))
    assert (verdict["verdict"], verdict["because"]) == ("held", "It is fitted to it.")
    measured = next(csv.DictReader((reported / "tables/claims-measured.csv").open()))
    numbers = [measured[key] for key in ("mean", "low", "high", "rigs")]
    assert numbers == ["1", "0.025", "1", "1 of 1"]  # the exact interval of one of one
    (each,) = csv.DictReader((reported / "tables/claims-by-rig-least-distortion.csv").open())
    assert float(each["t265"]) < 1


def test_what_became_of_the_source_s_parts_is_told(reported: Path) -> None:
    (part,) = csv.DictReader((reported / "tables/source-parts.csv").open())
    assert (part["status"], part["why"]) == ("impossible", "They are not public.")
    assert "They are not public." in " ".join(Page(reported / "index.html").words)


def test_latex_of_all_parts_is_plain_and_balanced(write_run: WriteRun) -> None:
    for table in all_tables(read_run(write_run(paper_rows(), spec=SPEC))):
        tex = to_latex(table)
        assert tex.isascii(), {c for c in tex if not c.isascii()}
        assert tex.count("{") == tex.count("}")


def test_pairs_that_read_alike_are_told_apart_by_their_motion(write_run: WriteRun) -> None:
    rows = [make_row("street", "t265", "exact", "abraham", motion=motion) for motion in ("wide", "rolled")]
    assert list(pair_labels(read_run(write_run(rows))).values()) == [
        "street\nt265\nwide",
        "street\nt265\nrolled",
    ]


def test_a_part_of_no_known_title_is_called_by_its_name(write_run: WriteRun) -> None:
    rows = [grouped("mine", make_row("street", "t265", "exact", "abraham"))]
    titles = [table.title for table in all_tables(read_run(write_run(rows)))]
    assert titles[0] == "mine: methods under the exact pose"
