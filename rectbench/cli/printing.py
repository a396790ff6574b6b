"""What the command line prints: tables for a person to read."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, get_args, get_origin

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table
from rich.text import Text

if TYPE_CHECKING:
    from rectbench.applications.choosing import Choice
    from rectbench.applications.conformance import Finding as CheckFinding
    from rectbench.applications.doctor import Finding
    from rectbench.applications.rectified_images import RectifiedImages
    from rectbench.matching import PoseEstimate
    from rectbench.metrics import Uncertainty
    from rectbench.rigs import Rig, RigCovariance
    from rectbench.runs.comparing import Comparison
    from rectbench.runs.gating import Gating

WIDE = 160
"""Columns assumed where the output is no terminal, so that a pipe gets whole lines."""

SHOWN_DIFFERENCES = 40


def console() -> Console:
    """Standard output; never narrower than a table where nobody looks at it."""
    screen = Console(highlight=False, soft_wrap=False)
    return screen if screen.is_terminal else Console(highlight=False, width=WIDE)


def show_names(kind: str, verbose: bool) -> None:
    """The names of a kind with a line about each; below, the plugins that cannot be loaded."""
    from rectbench.experiments.spec import REPORTS
    from rectbench.metrics.scoring import BUNDLES
    from rectbench.plugins.figure import FIGURES
    from rectbench.plugins.metric import METRICS
    from rectbench.plugins.rectifier import METHODS
    from rectbench.plugins.scene import SCENES
    from rectbench.registry import Kind, registry
    from rectbench.rigs.file_formats import FORMATS

    screen, table = console(), _table(kind)
    broken: dict[str, str] = {}
    known_kinds = (METHODS, SCENES, METRICS, REPORTS, FIGURES, FORMATS)
    kinds: dict[str, Kind[Any]] = {known.name: known for known in known_kinds}
    if kind in kinds:
        found = registry(kinds[kind])
        broken = found.broken
        for plugin in found.plugins():
            table.add_row(plugin.name, plugin.summary)
            if verbose and kind == "methods":
                _add_options(table, plugin.value)
        for bundle, members in BUNDLES.items() if kind == "metrics" else ():
            table.add_row(bundle, f"Together: {', '.join(members)}.")
    else:
        for name, summary in _described(kind):
            table.add_row(name, summary)
    screen.print(table)
    for place, reason in broken.items():
        screen.print(Text(f"  broken: {place}: {reason}", style="red"))
    screen.print()


def _described(kind: str) -> list[tuple[str, str]]:
    from rectbench.calibrations import load_rig, rig_names
    from rectbench.pairs.spec import ESTIMATED
    from rectbench.rigs import MOTIONS, POSES

    if kind == "motions":
        return [(motion.name, motion.description) for motion in MOTIONS.values()]
    if kind == "poses":
        noises = [
            (name, f"rotation off by {noise.rotation_deg:g}°, baseline by {noise.direction_deg:g}°")
            for name, noise in POSES.items()
        ]
        return [*noises, (ESTIMATED, "found in the images: features, five points, bundle adjustment")]
    rigs = [(name, load_rig(name)) for name in rig_names()]
    return [
        (name, f"{r.left.model}, {r.left.width}x{r.left.height}, baseline {1000 * r.baseline_m:.0f} mm")
        for name, r in rigs
    ]


def _add_options(table: Table, method: Any) -> None:
    for name, option in method.Options.model_fields.items():
        limits = [_LIMITS[type(limit).__name__].format(limit) for limit in option.metadata]
        kind = ", ".join([_kind_text(option.annotation), *limits, f"default {_plain(option.default)}"])
        text = f"{option.description} ({kind})"
        table.add_row(f"  --option {method.name}.{name}", text, style="dim")
    for reference in method.references:
        table.add_row("", reference, style="dim italic")


_LIMITS = {"Gt": "> {0.gt}", "Ge": "≥ {0.ge}", "Lt": "< {0.lt}", "Le": "≤ {0.le}"}


def _kind_text(annotation: Any) -> str:
    """A type as a user writes its values: choices, or number, text, ..."""
    if get_origin(annotation) is Literal:
        return " | ".join(map(str, get_args(annotation)))
    if get_args(annotation):
        return " or ".join(_kind_text(part) for part in get_args(annotation))
    names = {float: "number", int: "whole number", str: "text", bool: "true | false", type(None): "nothing"}
    return names.get(annotation, str(annotation))


def _plain(default: Any) -> str:
    return "none" if default is None else str(default)


def show_summary(folder: Path) -> None:
    """The main tables of a run, and where its page is."""
    from rectbench.reporting.tables.tabulation import main_tables
    from rectbench.runs.run import read_run

    screen, found = console(), read_run(folder)
    page_only = {column.key for column in found.catalogue.shown("page")}  # they make it too wide
    for summary in main_tables(found):
        caption = " ".join([summary.caption, *summary.notes])
        table = Table(title=summary.title, caption=caption, box=SIMPLE_HEAD, pad_edge=False)
        shown = [i for i, heading in enumerate(summary.headings) if heading.key not in page_only]
        for i in shown:
            heading = summary.headings[i]
            # On a narrow screen the headings are folded, never the numbers.
            widest = max(len(row[i].text) for row in summary.rows)
            side: Literal["left", "right"] = "right" if heading.numeric else "left"
            table.add_column(Text(heading.text), justify=side, min_width=widest)  # [px] is no markup
        for row in summary.rows:
            table.add_row(*(Text(row[i].text, style="bold" if row[i].best else "") for i in shown))
        screen.print(table)
    for failure in found.failures:
        cell = f"{failure.method} on {failure.scene}/{failure.rig}/{failure.motion}/{failure.pose}"
        screen.print(Text(f"{failure.status}: {cell}: {failure.reason}", style="yellow"))
    screen.print(f"{len(found.results)} cells; page: {folder / 'index.html'}", soft_wrap=True)


def show_gating(found: Gating) -> None:
    """What a gate found, worst first."""
    screen = console()
    for title, lines, style in (
        ("regression", found.regressions, "red"),
        ("incomplete", found.incomplete, "yellow"),
        ("improvement", found.improvements, "green"),
        ("new", found.new, "dim"),
    ):
        for line in lines:
            screen.print(Text(f"{title}: {line}", style=style), soft_wrap=True)
    answer = {0: "good", 1: "worse than accepted"}.get(found.exit_code, "incomplete or nothing measured")
    screen.print(f"{found.compared} cells compared: {answer}")


def show_comparison(comparison: Comparison, metrics: list[str] | None) -> None:
    """The paired differences, a row a method and metric."""
    screen, table = console(), _table("method", "metric", "pairs", "A", "B", "B - A", "95 % interval")
    for row in comparison.table.to_dict("records"):
        if metrics is not None and row["metric"] not in metrics:
            continue
        interval = "" if row["low"] != row["low"] else f"{row['low']:.3g} to {row['high']:.3g}"
        numbers = (f"{row[name]:.5g}" for name in ("median_a", "median_b"))
        table.add_row(
            row["method"], row["metric"], str(row["pairs"]), *numbers, f"{row['difference']:+.3g}", interval
        )
    screen.print(table)
    for line in comparison.unpaired[:SHOWN_DIFFERENCES]:
        screen.print(Text(line, style="yellow"), soft_wrap=True)
    if len(comparison.unpaired) > SHOWN_DIFFERENCES:
        screen.print(f"... and {len(comparison.unpaired) - SHOWN_DIFFERENCES} more cells in one run alone")


def show_pose(estimate: PoseEstimate, rig: Rig) -> None:
    """An estimated pose, how sure it is, and how far the calibration's own is from it."""
    screen, table = console(), Table(box=None, pad_edge=False, show_header=False)
    rotation_deg, direction_deg = estimate.difference_deg(rig)
    (a, b, c), (x, y, z) = estimate.rotation_vector_deg, estimate.direction_right_left
    found, seconds = len(estimate.inliers.left), estimate.seconds
    for name, value, remark in (
        ("rotation", f"({a:+.3f}, {b:+.3f}, {c:+.3f})°", f"± {estimate.rotation_sigma_deg:.3f}°"),
        ("direction", f"({x:+.4f}, {y:+.4f}, {z:+.4f})", f"± {estimate.direction_sigma_deg:.3f}°"),
        ("motion", estimate.motion, ""),
        ("matches", f"{found} of {estimate.given} fit", f"noise {estimate.noise_px:.2f} px a coordinate"),
        ("calibration", f"rotation {rotation_deg:.3f}° off", f"direction {direction_deg:.3f}° off"),
        (
            "time",
            f"{sum(seconds.values()):.2f} s",
            ", ".join(f"{stage} {took:.2f}" for stage, took in seconds.items()),
        ),
    ):
        table.add_row(name, value, remark)
    screen.print(table)
    if estimate.note:
        screen.print(Text(f"warning: {estimate.note}", style="yellow"), soft_wrap=True)


_COSTS: tuple[tuple[str, Callable[[Mapping[str, float]], str]], ...] = (
    ("size", lambda c: f"{c['width_px']:.0f}x{c['height_px']:.0f} px"),
    (
        "resolution in the middle",
        lambda c: f"{c['focal_px']:.1f} px/rad, {c['magnification']:.0%} of the source's",
    ),
    ("source pixels kept", lambda c: f"{c['coverage_pixels']:.1%}"),
    ("field of view kept", lambda c: f"{c['coverage_solid_angle']:.1%}"),
    ("overlap kept", lambda c: f"{c['coverage_overlap']:.1%}"),
    ("output that shows anything", lambda c: f"{c['valid_output']:.1%}"),
    ("pixels lost by shrinking", lambda c: f"{c['sampling_lost']:.1%}"),
    ("pixels invented by stretching", lambda c: f"{c['sampling_invented']:.1%}"),
    ("log distortion", lambda c: f"{c['log_distortion_kept']:.3f}"),
)
"""What a frame costs, by the numbers of `frame_costs`."""


def show_rectified(made: RectifiedImages) -> None:
    """What a rectification costs, how good its rows are, what was left out, and where the files are."""
    screen = console()
    if made.choice is not None:
        _show_choice(screen, made.choice)
    columns = ["this frame"] + ([] if made.own_costs is None else ["the method's own frame"])
    table = _table(made.method, *columns)
    for name, text in _COSTS:
        costs = (made.costs, made.own_costs)
        table.add_row(name, *(text(cost) for cost in costs if cost is not None))
    if "averaged_share" in made.costs:
        share, longest = made.costs["averaged_share"], made.costs["longest_footprint_px"]
        table.add_row("averaged over several source pixels", f"{share:.1%}, over up to {longest:.1f} px")
    for kind, words in (("board", "rows, corners of a board"), ("features", "rows, features")):
        if f"row_error_{kind}_median_px" in made.rows:
            median, p95, count = (
                made.rows[f"row_error_{kind}_{n}"] for n in ("median_px", "p95_px", "matches")
            )
            table.add_row(words, f"{median:.2f} px in the median, {p95:.2f} px at 95 %, of {count:.0f}")
    screen.print(table)
    for reason in made.left_out:
        screen.print(Text(f"left out: {reason}", style="yellow"), soft_wrap=True)
    for result in made.pairs:
        if result.note:
            screen.print(Text(f"{result.pair.name}: {result.note}", style="dim"), soft_wrap=True)
    if made.warning:
        screen.print(Text(f"warning: {made.warning}", style="yellow"), soft_wrap=True)
    for file in made.files if len(made.pairs) == 1 else made.files[-1:]:
        print(file)


def _show_choice(screen: Console, choice: Choice) -> None:
    table = _table("method", "log distortion", "rows [px]", "size", "")
    for candidate in choice.candidates:
        found = candidate.measured
        rows = found.get("row_error_source_median_px")
        size = f"{found['width_px']:.0f}x{found['height_px']:.0f}" if found else ""
        numbers = (
            f"{found['log_distortion_kept']:.3f}" if found else "",
            "" if rows is None else f"{rows:.2f}",
        )
        table.add_row(candidate.method, *numbers, size, Text(candidate.reason, style="yellow"))
    screen.print(table)
    screen.print(f"{choice.why}.\n", soft_wrap=True)


def show_uncertainty(found: Uncertainty, covariance: RigCovariance) -> None:
    """What an unsure calibration does to rows and distances, a line for each distance; and by what."""
    screen = console()
    rows = _table(
        "points at", "row error σ", "95 %", "most", "mean |error|", "distance σ", "95 %", "matched σ"
    )
    shares = _table("share of the variance", "in", *found.row_error_shares)
    for k, numbers in enumerate(found.numbers()):
        depth_m = numbers["depth_m"]
        place = "infinity" if math.isinf(depth_m) else f"{depth_m:.3g} m"
        rows.add_row(
            place,
            *(f"{numbers[f'row_error_sigma_{name}_px']:.3f} px" for name in ("rms", "p95", "max")),
            f"{numbers['row_error_expected_mean_px']:.3f} px",
            *(_percent(numbers[f"depth_sigma_{name}_share"]) for name in ("median", "p95", "median_matched")),
        )
        for name, groups in (("row error", found.row_error_shares), ("distance", found.depth_shares)):
            shares.add_row(place, name, *(_whole_percent(float(share[k])) for share in groups.values()))
    screen.print(Text(f"calibration: {covariance.source}"), soft_wrap=True)
    screen.print(rows)
    screen.print()
    screen.print(shares)
    if any(
        (share < -0.005).any() for share in (*found.row_error_shares.values(), *found.depth_shares.values())
    ):
        screen.print("below 0: what one group adds, another that it is correlated with takes away")


def _percent(share: float) -> str:
    return "–" if math.isnan(share) else f"{100 * share:.2g} %" if share < 0.1 else f"{100 * share:.0f} %"


def _whole_percent(share: float) -> str:
    return "–" if math.isnan(share) else f"{round(100 * share)} %"


def show_checks(method: str, findings: Iterable[CheckFinding]) -> int:
    """The conformance table; returns how many checks failed."""
    screen, table, failed = console(), _table("rig", "check", "result", "found"), 0
    styles = {"passed": "green", "failed": "bold red", "unsupported": "yellow"}
    for finding in findings:
        failed += finding.result == "failed"
        result = Text(finding.result, style=styles[finding.result])
        table.add_row(finding.rig, finding.check, result, Text(finding.detail))
    screen.print(table)
    screen.print(f"{method}: {failed} checks failed" if failed else f"{method}: all checks passed")
    return failed


def show_examination(findings: Iterable[Finding]) -> bool:
    """The doctor's table; returns whether nothing that is needed is missing."""
    screen, table, well = console(), _table("", "what", "found"), True
    for finding in findings:
        mark = {True: Text("ok", style="green"), False: Text("MISSING", style="bold red"), None: Text("-")}[
            finding.ok
        ]
        table.add_row(mark, finding.name, Text(finding.text))
        well = well and finding.ok is not False
    screen.print(table)
    screen.print("rectbench can run here" if well else "rectbench cannot run here")
    return well


def _table(*headings: str) -> Table:
    """A plain table; a single heading stands above two columns, name and meaning."""
    table = Table(box=None, pad_edge=False)
    columns = headings if len(headings) > 1 else (*headings, "")
    for heading in columns:
        table.add_column(Text(heading), header_style="bold", overflow="fold")  # [px] is no markup
    return table
