"""Runs a plan: what the store has is taken, pairs are rendered, cells run; outcomes in plan order."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace

from rectbench.errors import InvalidInput, argument
from rectbench.experiments.execution.cells import CELLS, cell_inputs, keep, run_cell, run_pair, stored_outcome
from rectbench.experiments.execution.outcomes import Outcome
from rectbench.experiments.execution.pool import Job, Workers
from rectbench.experiments.execution.worker import Limits
from rectbench.experiments.planning import Plan
from rectbench.experiments.spec import Report
from rectbench.experiments.tasks import CellTask
from rectbench.pairs.opening import open_pair
from rectbench.pairs.pair import Pair
from rectbench.pairs.spec import PairSpec, RenderedSpec
from rectbench.progress import Advance, Progress
from rectbench.store.keys import digest
from rectbench.store.store import Store


@dataclass(frozen=True)
class Interrupted(Exception):
    """Ctrl-C: what was finished is in the store, and the next run goes on from there."""

    finished: int
    cells: int

    def __str__(self) -> str:
        return f"interrupted; {self.finished} of {self.cells} cells are kept, the same command goes on there"


@dataclass(frozen=True)
class Execution:
    """How the tasks of a plan ended, and who worked on them."""

    plan: Plan
    outcomes: Sequence[Outcome]
    """In the plan's order."""
    jobs: int
    threads_per_job: int
    dask: str | None


def execute(
    plan: Plan,
    workers: Workers,
    *,
    dask: str | None = None,
    fresh: bool = False,
    progress: Progress | None = None,
) -> Execution:
    """Run the cells of a plan that the store does not have; raises Interrupted on Ctrl-C.

    Parameters
    ----------
    workers : who renders and runs the cells. The outcomes do not depend on their number.
    dask : address of a dask.distributed scheduler that runs the cells in the place of local workers.
    fresh : make again what the store has of this plan.
    progress : where to tell how far it is; nowhere by default.
    """
    runner = _Runner(plan, Store.default(), workers, progress or Progress())
    if fresh:
        runner.forget()
    return Execution(plan, runner.outcomes(dask), workers.count, workers.limits.threads, dask)


def workers_for(report: Report, jobs: int | None = None) -> Workers:
    """Worker processes, one a core by default, within what a report allows; started when work is there."""
    count = checked_jobs(jobs)
    threads = max(1, (os.cpu_count() or 1) // count)
    return Workers(count, Limits(threads, round(report.memory_gib * 2**30)))


def checked_jobs(jobs: int | None) -> int:
    """The worker processes wanted; raises InvalidInput for a number that is none."""
    if jobs is None:
        return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    if isinstance(jobs, bool) or not isinstance(jobs, int) or jobs < 1:
        raise InvalidInput(f"{argument('jobs')} is {jobs!r}; expected a whole number from 1 on")
    return jobs


class _Runner:
    """One run of a plan against a store."""

    def __init__(self, plan: Plan, store: Store, workers: Workers, progress: Progress) -> None:
        self.plan, self.store, self.workers, self.progress = plan, store, workers, progress
        self.pairs = {spec: open_pair(spec, store) for spec in plan.pairs}

    def forget(self) -> None:
        """Drop from the store what this plan would find there."""
        for task in self.plan.tasks:
            self.store.drop(self.store.place(CELLS, cell_inputs(task, self._pair(task))))
        for pair in self.pairs.values():
            pair.forget()

    def _pair(self, task: CellTask) -> Pair:
        return self.pairs[task.pair]

    def outcomes(self, dask: str | None) -> list[Outcome]:
        """The outcome of each task, in the plan's order."""
        tasks = self.plan.tasks
        found = [stored_outcome(task, self._pair(task)) for task in tasks]
        try:
            if dask is not None:
                self._run_on_cluster(dask, found)
            else:
                self._render_and_run(found)
                self._run_alone(found)
        except KeyboardInterrupt:
            done = sum(outcome is not None for outcome in found)
            raise Interrupted(done, len(tasks)) from None
        return [outcome for outcome in found if outcome is not None]

    def _render_and_run(self, found: list[Outcome | None]) -> None:
        """Render the pairs the store lacks, and run the cells of each that is there; not those to run alone.

        The cells of a pair that cannot be made end as it did.
        """
        tasks, lacking = self.plan.tasks, self._lacking_pairs(found)
        place: dict[PairSpec, int] = {spec: position for position, spec in enumerate(lacking)}
        missing = [i for i, outcome in enumerate(found) if outcome is None and not tasks[i].alone]
        jobs = [self._pair_job(spec) for spec in lacking]
        jobs += [self._cell_job(tasks[index], place.get(tasks[index].pair)) for index in missing]
        with ExitStack() as stack:
            rendered = stack.enter_context(self.progress.stage("rendering", len(lacking)))
            advance = stack.enter_context(self._cells_stage("cells", found, missing))
            for position, outcome in self.workers.run(jobs):
                if position >= len(lacking):
                    found[missing[position - len(lacking)]] = outcome
                    advance()
                    continue
                rendered()
                if outcome.ok:
                    continue
                lost = replace(outcome, reason=f"rendering the pair: {outcome.reason}")
                for index, task in enumerate(tasks):
                    if found[index] is None and task.pair == lacking[position]:
                        found[index] = lost
                        advance()

    def _run_alone(self, found: list[Outcome | None]) -> None:
        """Run the cells that are to have the machine to themselves."""
        missing = [index for index, outcome in enumerate(found) if outcome is None]
        if not missing:
            return
        count, limits = self.workers.count, self.workers.limits
        jobs = [self._cell_job(self.plan.tasks[index]) for index in missing]
        with (
            Workers(1, replace(limits, threads=count * limits.threads)) as worker,
            self._cells_stage("cells, one at a time", found, missing) as advance,
        ):
            for position, outcome in worker.run(jobs):
                found[missing[position]] = outcome
                advance()

    @contextmanager
    def _cells_stage(
        self, title: str, found: Sequence[Outcome | None], missing: Sequence[int]
    ) -> Iterator[Advance]:
        """A stage of all cells that are known or to be run now, the known ones done."""
        done = sum(outcome is not None for outcome in found)
        with self.progress.stage(title, done + len(missing)) as advance:
            for _ in range(done):
                advance()
            yield advance

    def _lacking_pairs(self, found: Sequence[Outcome | None]) -> list[RenderedSpec]:
        """The pairs to be rendered; one with images even if its rows are known: the report shows it."""
        wanted = dict.fromkeys(
            task.pair
            for task, outcome in zip(self.plan.tasks, found, strict=True)
            if isinstance(task.pair, RenderedSpec) and (outcome is None or task.pair.images)
        )
        return [spec for spec in wanted if not self.pairs[spec].is_made]

    def _pair_job(self, spec: RenderedSpec) -> Job:
        arguments = (spec, self.store.root)
        return Job(run_pair, arguments, self.plan.report.render_timeout_s, ((spec.scene_source, spec.seed),))

    def _cell_job(self, task: CellTask, after: int | None = None) -> Job:
        return Job(run_cell, (task, self.store.root), self.plan.report.timeout_s, (task.pair,), after)

    def _run_on_cluster(self, address: str, found: list[Outcome | None]) -> None:
        from rectbench.experiments.execution.cluster import run_on_cluster

        missing = [index for index, outcome in enumerate(found) if outcome is None]
        report = self.plan.report
        tasks = [self.plan.tasks[index] for index in missing]
        inputs = [cell_inputs(task, self._pair(task)) for task in tasks]
        ended: Iterable[tuple[int, Outcome]] = run_on_cluster(
            address,
            [(task, digest(shaping)) for task, shaping in zip(tasks, inputs, strict=True)],
            timeout_s=report.timeout_s + report.render_timeout_s,  # the first cell of a pair renders it
            limits=self.workers.limits,
        )
        with self.progress.stage("cells", len(missing)) as advance:
            for position, outcome in ended:
                found[missing[position]] = outcome
                keep(self.store, inputs[position], outcome)
                advance()
