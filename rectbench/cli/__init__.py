"""The command line. Every verb is a few lines over a function that anybody can call; imports all below.

What a verb needs beside its request is imported when it runs, so that `rectbench --help` is there at once.
Exit codes: 0 good, 1 a regression or a failed check, 2 wrong usage or a broken environment,
3 incomplete or nothing measured.
"""

from __future__ import annotations

import logging
import sys

from rectbench.cli import machine, photographs, rendering, running
from rectbench.cli.app import WRONG_USAGE, app
from rectbench.errors import RectbenchError
from rectbench.experiments.execution.worker import silence_warnings

for command in (
    machine.list_,
    running.run,
    running.report,
    running.gate,
    running.compare,
    running.plan,
    rendering.render,
    rendering.export,
    photographs.rectify,
    photographs.pose,
    photographs.reconstruct,
    photographs.uncertainty,
    photographs.convert,
    machine.check,
    machine.doctor,
    machine.gc,
):
    app.command(command.__name__.strip("_"))(command)


def main() -> None:
    """Run the command line; a known error is one line on stderr, or what lines it has."""
    logging.basicConfig(format="rectbench: %(message)s", level=logging.WARNING)
    silence_warnings()
    try:
        status = app(standalone_mode=False)
    except (RectbenchError, OSError) as error:
        status = _complain(error)
    except Exception as error:
        # Typer ships its own copy of Click or uses the installed one: usage errors are known by shape.
        message = getattr(error, "format_message", None)
        if message is None:
            raise
        status = _complain(message())
    sys.exit(status if isinstance(status, int) else 0)


def _complain(error: object) -> int:
    if str(error):  # without a verb there is only the help, printed already
        lines = str(error).splitlines() if getattr(error, "has_lines", False) else [str(error)]
        for line in lines:
            print(f"rectbench: {' '.join(line.split())}", file=sys.stderr)
    return WRONG_USAGE
