"""Seconds of each stage as grouped bars, with those that somebody else stated as lines."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from rectbench.plugins.figure import Drawing, Figure, FigureData
from rectbench.plugins.result import Part
from rectbench.reporting.charts.grouped_bars import BarChart, bar_drawing, bar_of


class Timing(Figure):
    """Seconds of each stage by rig, beside those that somebody else stated."""

    name = "timing"
    topic = "Time"

    def drawings(self, given: FigureData) -> Iterator[Drawing]:
        """One chart, where any stage was timed."""
        stages = given.part.catalogue.panels("Time")
        if not any(key in given.part.metrics for key in stages):
            return
        stated = dict(given.run.stated_seconds)
        if stated:
            stated["total"] = sum(stated.values())
        chart = stage_chart(given.part, stages, stated)
        caption = "Seconds of each stage, tables being part of the warp" + (
            "; the lines are stated, not measured here." if stated else "."
        )
        yield bar_drawing(chart, given, "timing", "Time", caption)


def stage_chart(run: Part, stages: Mapping[str, str], stated: Mapping[str, float]) -> BarChart:
    """Seconds of each stage (column to name), a panel a rig and width; `stated` are somebody else's."""
    panels = {
        rig: {
            name: {
                method: bar_of(run.select(rig=rig, method=method), key, 1.0)
                for method in run.methods
                if run.select(rig=rig, method=method)
            }
            for key, name in stages.items()
            if key in run.metrics
        }
        for rig in run.rigs
    }
    return BarChart("time [s]", 1e-4, None, run.methods, panels, stated)
