"""How many rigs, scenes and seeds a report would take to tell a difference, by a run of it."""

from __future__ import annotations

from rectbench.applications.requests.running import PlanRequest
from rectbench.errors import InvalidInput
from rectbench.experiments.planning import find_report
from rectbench.experiments.spec import Report
from rectbench.runs.designing import Design, design
from rectbench.runs.making import run_folder
from rectbench.runs.record import RUN_FILE, read_record


def plan_report(request: PlanRequest) -> Design:
    """What the run's design tells, see `runs.designing.design`.

    Raises InvalidInput where there is no run yet, or one of another report.
    """
    name, folder = find_report(request.report).name, run_folder(request.report, request.run)
    if not (folder / RUN_FILE).is_file():
        of = name if isinstance(request.report, Report) else request.report
        made = f"`rectbench run {of} --out {folder}`"
        raise InvalidInput(f"{folder} holds no run yet; expected one, which {made} makes")
    if (found := read_record(folder).report) != name:
        raise InvalidInput(f"{folder} is a run of {found}; expected one of {name}")
    return design(folder, request.detect, request.metric)
