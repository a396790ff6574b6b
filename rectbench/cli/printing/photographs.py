"""What a rectification costs, an estimated pose, and what an unsure calibration does, as tables."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from rich.table import Table
from rich.text import Text

from rectbench.cli.printing.screen import console, plain_table

if TYPE_CHECKING:
    from rich.console import Console

    from rectbench.applications.choose_method import Choice
    from rectbench.applications.photographs.rectified import RectifiedImages
    from rectbench.matching import PoseEstimate
    from rectbench.metrics import Uncertainty
    from rectbench.rigs import Rig, RigCovariance


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
    frames = {"this frame": made.costs}
    if made.own_costs is not None:
        frames["the method's own frame"] = made.own_costs
    table = plain_table(made.method, *frames)
    for name, text in _COSTS:
        table.add_row(name, *map(text, frames.values()))
    if "averaged_share" in made.costs:
        share, longest = made.costs["averaged_share"], made.costs["longest_footprint_px"]
        table.add_row("averaged over several source pixels", f"{share:.1%}, over up to {longest:.1f} px")
    for kind, words in (("board", "rows, corners of a board"), ("features", "rows, features")):
        if f"row_error_{kind}_median_px" in made.rows:
            names = ("median_px", "p95_px", "matches")
            median, p95, count = (made.rows[f"row_error_{kind}_{name}"] for name in names)
            table.add_row(words, f"{median:.2f} px in the median, {p95:.2f} px at 95 %, of {count:.0f}")
    screen.print(table)
    for remark in made.remarks:
        screen.print(Text(remark), soft_wrap=True)
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
    table = plain_table("method", "log distortion", "rows [px]", "size", "")
    for candidate in choice.candidates:
        found = candidate.measured
        rows = found.get("row_error_source_median_px")
        rows_px = "" if rows is None else f"{rows:.2f}"
        value = found.get("log_distortion_on_view", math.nan)
        distortion = f"{value:.3f}" if math.isfinite(value) else "–" if found else ""
        size = f"{found['width_px']:.0f}x{found['height_px']:.0f}" if found else ""
        table.add_row(candidate.method, distortion, rows_px, size, Text(candidate.reason, style="yellow"))
    screen.print(table)
    screen.print(f"{choice.why}.\n", soft_wrap=True)


def show_pose(estimate: PoseEstimate, rig: Rig) -> None:
    """An estimated pose, how sure it is, and how far the calibration's own is from it."""
    screen, table = console(), Table(box=None, pad_edge=False, show_header=False)
    rotation_deg, direction_deg = estimate.difference_deg(rig)
    (a, b, c), (x, y, z) = estimate.rotation_vector_deg, estimate.direction_right_left
    found, seconds = len(estimate.inliers.left), estimate.seconds
    stages = ", ".join(f"{stage} {took:.2f}" for stage, took in seconds.items())
    row = table.add_row
    row("rotation", f"({a:+.3f}, {b:+.3f}, {c:+.3f})°", f"± {estimate.rotation_sigma_deg:.3f}°")
    row("direction", f"({x:+.4f}, {y:+.4f}, {z:+.4f})", f"± {estimate.direction_sigma_deg:.3f}°")
    row("motion", estimate.motion)
    row("matches", f"{found} of {estimate.given} fit", f"noise {estimate.noise_px:.2f} px a coordinate")
    row("calibration", f"rotation {rotation_deg:.3f}° off", f"direction {direction_deg:.3f}° off")
    row("time", f"{sum(seconds.values()):.2f} s", stages)
    screen.print(table)
    if estimate.note:
        screen.print(Text(f"warning: {estimate.note}", style="yellow"), soft_wrap=True)


def show_uncertainty(found: Uncertainty, covariance: RigCovariance) -> None:
    """What an unsure calibration does to rows and distances, a line for each distance; and by what."""
    screen = console()
    rows = plain_table(
        "points at", "row error σ", "95 %", "most", "mean |error|", "distance σ", "95 %", "matched σ"
    )
    shares = plain_table("share of the variance", "in", *found.row_error_shares)
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
    every_share = (*found.row_error_shares.values(), *found.depth_shares.values())
    if any((share < -0.005).any() for share in every_share):
        screen.print("below 0: what one group adds, another that it is correlated with takes away")


def _percent(share: float) -> str:
    return "–" if math.isnan(share) else f"{100 * share:.2g} %" if share < 0.1 else f"{100 * share:.0f} %"


def _whole_percent(share: float) -> str:
    return "–" if math.isnan(share) else f"{round(100 * share)} %"
