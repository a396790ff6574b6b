"""The verbs about this machine and its plugins."""

from __future__ import annotations

from typing import Annotated

import typer

from rectbench.cli.app import WRONG_USAGE


def check(
    plugin: Annotated[
        str, typer.Argument(metavar="PLUGIN", help="A method's name, or the path of its file.")
    ],
) -> None:
    """Run the conformance suite over a method; exit code 1 where a check fails."""
    from rectbench.applications.conformance import check_method
    from rectbench.cli import printing as terminal
    from rectbench.plugins.rectifier import METHODS
    from rectbench.registry import registry

    method = registry(METHODS).get(plugin)
    failed = terminal.show_checks(method.name, check_method(method))
    raise typer.Exit(1 if failed else 0)


def doctor() -> None:
    """Tell what is there and what is missing; exit code 2 where rectbench cannot run."""
    from rectbench.applications.doctor import examine
    from rectbench.cli import printing as terminal

    raise typer.Exit(0 if terminal.show_examination(examine()) else WRONG_USAGE)


def gc(
    older_than: Annotated[
        float | None, typer.Option(metavar="DAYS", min=0, help="Remove what was not used for so long.")
    ] = None,
    larger_than: Annotated[
        float | None, typer.Option(metavar="GIB", min=0, help="Remove the longest unused beyond this size.")
    ] = None,
) -> None:
    """Remove rendered pairs and finished cells from the store; without options, tell its size."""
    from rectbench.store.store import Store

    store = Store.default()
    if older_than is not None or larger_than is not None:
        removed = store.collect(older_than, None if larger_than is None else round(larger_than * 2**30))
        print(f"removed {len(removed)} objects, {sum(entry.size_bytes for entry in removed) / 2**20:.0f} MiB")
    entries = store.entries()
    print(
        f"{store.root}: {len(entries)} objects, {sum(entry.size_bytes for entry in entries) / 2**20:.0f} MiB"
    )
