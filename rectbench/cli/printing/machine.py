"""Names and options of what there is, a plugin's checks, and what the doctor found, as tables."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, Literal, get_args, get_origin

from rich.table import Table
from rich.text import Text

from rectbench.applications.listing import listed
from rectbench.cli.printing.screen import console, plain_table

if TYPE_CHECKING:
    from rectbench.applications.check_method import CheckResult
    from rectbench.applications.doctor import Finding


def show_names(kind: str, verbose: bool) -> None:
    """The names of a kind with a line about each; below, the plugins that cannot be loaded."""
    screen, table, found = console(), plain_table(kind), listed(kind)
    for entry in found.entries:
        table.add_row(entry.name, entry.summary)
        if entry.columns:
            table.add_row("", ", ".join(entry.columns), style="dim")
        if verbose and hasattr(entry.value, "Options"):
            _add_options(table, entry.value)
    screen.print(table)
    for place, reason in found.broken.items():
        screen.print(Text(f"  broken: {place}: {reason}", style="red"))
    screen.print()


def _add_options(table: Table, method: Any) -> None:
    for name, option in method.Options.model_fields.items():
        limits = [_LIMITS[type(limit).__name__].format(limit) for limit in option.metadata]
        default = "none" if option.default is None else option.default
        kind = ", ".join([_kind_text(option.annotation), *limits, f"default {default}"])
        text = f"{option.description} ({kind})"
        table.add_row(f"  --option {method.name}.{name}", text, style="dim")
    for reference in method.references:
        table.add_row("", reference, style="dim italic")


_LIMITS = {"Gt": "> {0.gt}", "Ge": "≥ {0.ge}", "Lt": "< {0.lt}", "Le": "≤ {0.le}"}


def _kind_text(annotation: Any) -> str:
    """A type as a user writes its values: choices, or number, text, ..."""
    if get_origin(annotation) is Literal:
        return " | ".join(map(str, get_args(annotation)))
    if get_args(annotation):
        return " or ".join(_kind_text(part) for part in get_args(annotation))
    names = {float: "number", int: "whole number", str: "text", bool: "true | false", type(None): "nothing"}
    return names.get(annotation, str(annotation))


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


def show_examination(findings: Iterable[Finding]) -> bool:
    """The doctor's table; returns whether nothing that is needed is missing."""
    screen, table, well = console(), plain_table("", "what", "found"), True
    for finding in findings:
        mark = {True: Text("ok", style="green"), False: Text("MISSING", style="bold red"), None: Text("-")}[
            finding.ok
        ]
        table.add_row(mark, finding.name, Text(finding.text))
        well = well and finding.ok is not False
    screen.print(table)
    screen.print("rectbench can run here" if well else "rectbench cannot run here")
    return well
