"""What an unsure calibration does."""

from __future__ import annotations

import math

from rich.text import Text

from rectbench.cli.printing.screen import console, plain_table
from rectbench.metrics import Uncertainty
from rectbench.rigs import RigCovariance


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
    if any(
        (share < -0.005).any() for share in (*found.row_error_shares.values(), *found.depth_shares.values())
    ):
        screen.print("below 0: what one group adds, another that it is correlated with takes away")


def _percent(share: float) -> str:
    return "–" if math.isnan(share) else f"{100 * share:.2g} %" if share < 0.1 else f"{100 * share:.0f} %"


def _whole_percent(share: float) -> str:
    return "–" if math.isnan(share) else f"{round(100 * share)} %"
