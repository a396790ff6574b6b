"""The same cells on an existing dask.distributed cluster.

A cell runs in a process of its own on the cluster's machines too, so that a crash or an endless loop
there costs that cell and no dask worker. Each machine keeps its own store, or shares one through
RECTBENCH_STORE; plugin and rig files given by path have to be there under the same path.
"""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from rectbench.errors import RectbenchError, Unavailable, argument
from rectbench.experiments.execution.cells import DESK, cell_inputs, run_cell
from rectbench.experiments.execution.outcomes import Outcome
from rectbench.experiments.execution.worker import Limits, restrict
from rectbench.experiments.tasks import CellTask
from rectbench.store.keys import digest
from rectbench.store.store import Store
from rectbench.writing import write_atomically

CONNECT_TIMEOUT_S = 10


def run_on_cluster(
    address: str, tasks: Sequence[tuple[CellTask, str]], *, timeout_s: float, limits: Limits
) -> Iterator[tuple[int, Outcome]]:
    """The outcome of each task with its index, as they end; beside a task stands the digest of its inputs.

    Raises Unavailable where dask is not installed or no scheduler answers at `address`.
    """
    try:
        from distributed import Client, as_completed
    except ImportError:
        raise Unavailable(
            f"{argument('dask')} needs the package distributed; pip install 'rectbench[dask]'"
        ) from None
    try:
        client = Client(address, timeout=CONNECT_TIMEOUT_S, set_as_default=False)
    except (OSError, ValueError) as error:
        raise Unavailable(f"no dask scheduler answers at {address}: {' '.join(str(error).split())}") from None
    with client:
        index_of = {}
        for index, (task, inputs) in enumerate(tasks):
            message = {"task": task.model_dump(mode="json"), "inputs": inputs, "limits": asdict(limits)}
            future = client.submit(run_isolated, message, timeout_s, pure=False)
            index_of[future] = index
        for future in as_completed(index_of, loop=client.loop):
            death = future.exception()
            yield index_of[future], _died(death) if death else Outcome(**future.result())


def run_isolated(message: dict[str, Any], timeout_s: float) -> dict[str, Any]:
    """Run a cell in a process of its own, on the machine of the dask worker that calls this."""
    with tempfile.TemporaryDirectory(prefix="rectbench-") as folder:
        answer = Path(folder) / "outcome.json"
        command = [sys.executable, "-m", "rectbench.experiments.execution.cluster", str(answer)]
        try:
            text = json.dumps(message)
            done = subprocess.run(command, input=text, text=True, timeout=timeout_s, check=False)
        except subprocess.TimeoutExpired:
            return asdict(Outcome("timeout", f"stopped after {timeout_s:g} s"))
        if answer.exists():
            outcome: dict[str, Any] = json.loads(answer.read_text(encoding="utf-8"))
            return outcome
    name = signal.Signals(-done.returncode).name if done.returncode < 0 else str(done.returncode)
    return asdict(Outcome("crash", f"the process of the cell ended with {name}"))


def _died(error: BaseException) -> Outcome:
    return Outcome("crash", f"on the cluster: {type(error).__name__}: {' '.join(str(error).split())}")


def _answer(message: dict[str, Any]) -> Outcome:
    restrict(Limits(**message["limits"]))
    task = CellTask.model_validate(message["task"])
    store = Store.default()
    try:
        inputs = digest(cell_inputs(task, DESK.pair(task.pair, store)))
    except RectbenchError as error:
        return Outcome("unavailable", f"on the cluster: {error}")
    if inputs != message["inputs"]:
        return Outcome("unavailable", "the cluster has other versions of rectbench, its plugins or libraries")
    return run_cell(task, store.root)


if __name__ == "__main__":
    # Whole or not at all, so that a process killed in between has given no answer.
    write_atomically(Path(sys.argv[1]), json.dumps(asdict(_answer(json.load(sys.stdin)))))
