"""The verbs about this machine and its plugins."""

from __future__ import annotations

from typing import Annotated

from typer import Argument, Option

from rectbench.applications.listing import LISTABLE
from rectbench.cli.app import FAILED, GOOD, WRONG_USAGE


def list_(
    kind: Annotated[str | None, Argument(metavar="KIND", help=f"One of {', '.join(LISTABLE)}.")] = None,
    verbose: Annotated[bool, Option("--verbose", "-v", help="With options and references.")] = False,
) -> int:
    """List methods, scenes, rigs, motions, poses and reports, and the plugins that cannot be loaded."""
    from rectbench.cli.printing.machine import show_names

    for one in LISTABLE if kind is None else (kind,):
        show_names(one, verbose)
    return GOOD


def check(
    plugin: Annotated[str, Argument(metavar="PLUGIN", help="A method's name, or the path of its file.")],
) -> int:
    """Run the conformance suite over a method; exit code 1 where a check fails."""
    from rectbench.applications.check_method import check_method
    from rectbench.cli.printing.machine import show_checks
    from rectbench.plugins.rectifier import METHODS
    from rectbench.registry import registry

    method = registry(METHODS).get(plugin)
    return FAILED if show_checks(method.name, check_method(method)) else GOOD


def doctor() -> int:
    """Tell what is there and what is missing; exit code 2 where rectbench cannot run."""
    from rectbench.applications.doctor import examine
    from rectbench.cli.printing.machine import show_examination

    return GOOD if show_examination(examine()) else WRONG_USAGE


def gc(
    older_than: Annotated[
        float | None, Option(metavar="DAYS", min=0, help="Remove what was not used for so long.")
    ] = None,
    larger_than: Annotated[
        float | None, Option(metavar="GIB", min=0, help="Remove the longest unused beyond this size.")
    ] = None,
) -> int:
    """Remove rendered pairs and finished cells from the store; without options, tell its size."""
    from rectbench.store.store import Entry, Store

    def told(entries: list[Entry]) -> str:
        return f"{len(entries)} objects, {sum(entry.size_bytes for entry in entries) / 2**20:.0f} MiB"

    store = Store.default()
    if older_than is not None or larger_than is not None:
        removed = store.collect(older_than, None if larger_than is None else round(larger_than * 2**30))
        print(f"removed {told(removed)}")
    print(f"{store.root}: {told(store.entries())}")
    return GOOD
