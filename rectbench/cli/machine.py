"""The verbs about this machine and its plugins."""

from __future__ import annotations

from rectbench.applications.listing import LISTABLE
from rectbench.applications.requests.machine import CheckRequest, CollectRequest, ListRequest
from rectbench.applications.requests.request import Request
from rectbench.cli.app import FAILED, GOOD, WRONG_USAGE, verb


@verb(ListRequest)
def list_(request: ListRequest) -> int:
    """List methods, scenes, rigs, motions, poses and reports, and the plugins that cannot be loaded."""
    from rectbench.cli.printing.names import show_names

    for kind in LISTABLE if request.kind is None else (request.kind,):
        show_names(kind, request.verbose)
    return GOOD


@verb(CheckRequest)
def check(request: CheckRequest) -> int:
    """Run the conformance suite over a method; exit code 1 where a check fails."""
    from rectbench.applications.check_method import check_method
    from rectbench.cli.printing.checks import show_checks
    from rectbench.plugins.rectifier import METHODS
    from rectbench.registry import registry

    method = registry(METHODS).get(request.plugin)
    return FAILED if show_checks(method.name, check_method(method)) else GOOD


@verb(Request)
def doctor(request: Request) -> int:
    """Tell what is there and what is missing; exit code 2 where rectbench cannot run."""
    from rectbench.applications.doctor import examine
    from rectbench.cli.printing.examination import show_examination

    return GOOD if show_examination(examine()) else WRONG_USAGE


@verb(CollectRequest)
def gc(request: CollectRequest) -> int:
    """Remove rendered pairs and finished cells from the store; without options, tell its size."""
    from rectbench.store.store import Entry, Store

    def told(entries: list[Entry]) -> str:
        return f"{len(entries)} objects, {sum(entry.size_bytes for entry in entries) / 2**20:.0f} MiB"

    store, largest_gib = Store.default(), request.larger_than
    if request.older_than is not None or largest_gib is not None:
        removed = store.collect(
            request.older_than, None if largest_gib is None else round(largest_gib * 2**30)
        )
        print(f"removed {told(removed)}")
    print(f"{store.root}: {told(store.entries())}")
    return GOOD
