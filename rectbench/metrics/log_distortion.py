"""Log distortion: how unevenly a rectification stretches, whatever its scale, on stated parts of the view."""

from __future__ import annotations

import math

from rectbench.margin import MARGIN_DEG
from rectbench.metrics.distortion import distortion_column
from rectbench.metrics.row_misfit import case_row_misfit, row_misfit
from rectbench.plugins.metric import Case, Column, Metric, Tolerance
from rectbench.rigs import Rig
from rectbench.scored import SHARES, Delivered, ScoredView
from rectbench.warps import Rectification
from rectbench.warps.jacobians import Jacobians, LogStretches

RANKING_SHARE = 0.95
"""Methods are ranked on this share of the view."""
SHOWN_SHARES = (0.5, 0.75, RANKING_SHARE, 1.0)
PARTS = ("log_distortion", "log_distortion_area", "log_distortion_anisotropy")


def log_distortion(jacobians: Jacobians) -> dict[str, float]:
    """RMS of log σ1 and log σ2 after their common mean over both images is removed, and its split.

    `log_distortion`² = `log_distortion_area`² + `log_distortion_anisotropy`²: what changes in size
    from place to place, and what is squeezed. No scale of the image changes it, collapse included.

    >>> import rectbench as rb
    >>> rect = rb.rectify(rb.load_rig("t265"), method="abraham")
    >>> found = log_distortion(Jacobians.at(rect))
    >>> round(found["log_distortion_area"] / found["log_distortion"], 1) < 1
    True
    """
    return dict(zip(PARTS, LogStretches.of(jacobians.both).distortion(jacobians.weights), strict=True))


def log_distortion_on_view(rect: Rectification, rig: Rig, share: float = RANKING_SHARE) -> float:
    """Log distortion on A_s, the `share` of the view nearest to its middle: what methods are ranked by.

    By the lookup tables, as they are delivered. NaN where the rectification does not show all of A_s, and
    where its rows are no epipolar planes of the rig, see `row_misfit`.

    >>> import rectbench as rb
    >>> rig = rb.load_rig("t265")
    >>> round(log_distortion_on_view(rb.rectify(rig, method="abraham"), rig), 2)
    0.26
    >>> log_distortion_on_view(rb.rectify(rig, method="conventional"), rig)
    nan
    """
    delivered = Delivered.of(rect, ScoredView.of(rig, margin_deg=rect.rig.margin_deg or MARGIN_DEG))
    return delivered.log_distortion(share) if row_misfit(rect, delivered, rig).rectifies else math.nan


def share_key(share: float) -> str:
    """The column of the log distortion on A_s.

    >>> share_key(0.95)
    'log_distortion_95'
    """
    return f"log_distortion_{100 * share:.0f}"


def _share_column(share: float) -> Column:
    ranks = share == RANKING_SHARE
    return distortion_column(
        share_key(share),
        f"log distortion, {100 * share:.0f} %",
        f"Log distortion on the {100 * share:.0f} % of the source pixels nearest to the middle of what both "
        "images see, the same for all methods; empty where a method does not show them all, or does not "
        "rectify." + ranks * " Methods are ranked by it.",
        tolerance=Tolerance(0.01, 1e-6) if share in SHOWN_SHARES else None,
        shown="summary" if share in SHOWN_SHARES else "rows",
        ranks=ranks,
    )


class LogDistortion(Metric):
    """RMS of the logarithms of the local stretches about their common mean, on shares of the view."""

    name, topic = "log_distortion", "Distortion"
    columns = (
        *map(_share_column, SHARES),
        distortion_column(
            "log_distortion",
            "log distortion, shown",
            "RMS of the logarithms of the local stretches σ1 ≥ σ2 about their common mean, over all that the "
            "method shows. Free of scale; but who shows less has less to distort.",
            tolerance=Tolerance(0.01, 1e-6),
            promised=True,
        ),
        distortion_column(
            "log_distortion_area", "log distortion, area", "The part of it that is change of area."
        ),
        distortion_column(
            "log_distortion_anisotropy",
            "log distortion, shape",
            "The part of it that is stretch in one direction.",
        ),
    )

    def compute(self, case: Case) -> dict[str, float]:
        """Of both images together, by their lookup tables."""
        delivered = case.delivered
        shares = delivered.shares_kept if case.once(case_row_misfit).rectifies else ()
        on_shares = {share_key(share): delivered.log_distortion(share) for share in shares}
        return on_shares | log_distortion(delivered.shown)
