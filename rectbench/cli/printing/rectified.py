"""What a rectification of photographs costs, and how its method was chosen."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from rich.console import Console
from rich.text import Text

from rectbench.applications.choose_method import Choice
from rectbench.applications.photographs.rectified import RectifiedImages
from rectbench.cli.printing.screen import console, plain_table

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
    table = plain_table(made.method, *columns)
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
    table = plain_table("method", "log distortion", "rows [px]", "size", "")
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
