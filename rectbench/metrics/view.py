"""View: how much of what both images see a rectification keeps, from its middle outwards."""

from __future__ import annotations

from rectbench.plugins.metric import Case, Column, Metric, Tolerance
from rectbench.scored import SHARES
from rectbench.warps import Perspective

PROJECTION, PERSPECTIVE = "projection", "perspective"
"""The note of a cell whose rectified images are perspective ones, whatever method made them."""


def across_key(share: float) -> str:
    """The column of the field of view that A_s fills.

    >>> across_key(0.5)
    'view_50_deg'
    """
    return f"view_{100 * share:.0f}_deg"


class View(Metric):
    """The share of the view that is wholly kept, and how wide shares of it are."""

    name, topic = "view", "Coverage"
    columns = (
        Column.share(
            "view_kept",
            "view kept",
            "higher",
            "The largest share of the source pixels, taken from the middle of what both images see "
            "outwards, of which "
            "the method shows every one.",
            tolerance=Tolerance(0.0, 0.005),
            shown="summary",
        ),
        *(
            Column(
                across_key(share),
                f"field of view, {100 * share:.0f} %",
                "°",
                None,
                f"Horizontal field of view of the {100 * share:.0f} % of the source pixels nearest to the"
                f" middle.",
                shown="rows",
            )
            for share in SHARES
        ),
    )

    def compute(self, case: Case) -> dict[str, float]:
        """Of both images: the lesser share kept, the mean field of view."""
        if all(isinstance(warp.target, Perspective) for warp in (case.rect.left, case.rect.right)):
            case.remarks[PROJECTION] = PERSPECTIVE
        view = case.pair.scored_view
        across = {across_key(share): view.across_deg(share) for share in SHARES}
        return {"view_kept": case.delivered.kept_share, **across}
