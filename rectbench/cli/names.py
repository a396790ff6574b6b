"""The verb that lists what there is."""

from __future__ import annotations

from typing import Annotated

import typer

from rectbench.errors import UnknownName

KINDS = ("methods", "scenes", "rigs", "motions", "poses", "metrics", "reports", "figures", "formats")


def list_(
    kind: Annotated[str | None, typer.Argument(metavar="KIND", help=f"One of {', '.join(KINDS)}.")] = None,
    verbose: Annotated[bool, typer.Option("--verbose", "-v", help="With options and references.")] = False,
) -> None:
    """List what there is of each kind, and the plugins that cannot be loaded."""
    from rectbench.cli import printing as terminal

    if kind is not None and kind not in KINDS:
        raise UnknownName("kind", kind, KINDS)
    for chosen in KINDS if kind is None else (kind,):
        terminal.show_names(chosen, verbose)
