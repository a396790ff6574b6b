"""The conformance table of a plugin."""

from __future__ import annotations

from collections.abc import Iterable

from rich.text import Text

from rectbench.applications.check_method import CheckResult
from rectbench.cli.printing.screen import console, plain_table


def show_checks(method: str, findings: Iterable[CheckResult]) -> int:
    """The conformance table; returns how many checks failed."""
    screen, table, failed = console(), plain_table("rig", "check", "result", "found"), 0
    styles = {"passed": "green", "failed": "bold red", "unsupported": "yellow"}
    for finding in findings:
        failed += finding.result == "failed"
        result = Text(finding.result, style=styles[finding.result])
        table.add_row(finding.rig, finding.check, result, Text(finding.detail))
    screen.print(table)
    screen.print(f"{method}: {failed} checks failed" if failed else f"{method}: all checks passed")
    return failed
