"""How probably one method is better than another in practice: the numbers of the figure beside it."""

from __future__ import annotations

import math

from rectbench.plugins.metric import Column
from rectbench.reporting.charts.critical_difference import LEAST_RIGS, decided, shown_beliefs
from rectbench.reporting.curves import ranked_by
from rectbench.reporting.names import named
from rectbench.reporting.tables.captions import counted
from rectbench.reporting.tables.table import Entry, Heading, Section, Table, number, text_heading, words
from rectbench.reporting.tables.tabulation import titled
from rectbench.runs.run import Run
from rectbench.statistics.bayes import EQUIVALENT, Belief

_PROBABILITY = Column.share("probability", "probability", None, "")
_LIKELY = 0.95
"""What is at least as probable is bold."""


def belief_table(run: Run) -> Table | None:
    """A row for each two methods; None with fewer than ten rigs, or a single method."""
    data = decided(run)
    if len(data.values) < 2 or data.rigs < LEAST_RIGS:
        return None
    region = f"{100 * EQUIVALENT:g} %"
    return Table(
        kind="beliefs",
        part=run.group,
        name=named(run, "beliefs"),
        title=titled(run, "How probably methods differ in practice"),
        caption=f"How probable it is on rigs of this kind that the one method or the other has less "
        f"{ranked_by(run.catalogue)} by {region} or more, or that they differ by less, which is no "
        f"difference in practice: Bayesian signed-rank test over {counted(data.rigs, 'rig')}. A method is "
        "the worse one on a rig where it has no number.",
        headings=(
            text_heading("method"),
            text_heading("other"),
            Heading("method is better [%]", "better"),
            Heading(f"less than {region} apart [%]", "equivalent"),
            Heading("other is better [%]", "worse"),
        ),
        sections=(Section("", tuple(map(_row, shown_beliefs(data)))),),
    )


def _row(belief: Belief) -> tuple[Entry, ...]:
    probabilities = (belief.a_better, belief.equivalent, belief.b_better)
    return words(belief.a), words(belief.b), *map(_probability, probabilities)


def _probability(value: float) -> Entry:
    told = None if math.isnan(value) else value
    return Entry(number(told, _PROBABILITY).text, told, best=value >= _LIKELY)
