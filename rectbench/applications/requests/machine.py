"""What the verbs about this machine and its plugins take."""

from __future__ import annotations

from rectbench.applications.listing import LISTABLE
from rectbench.applications.requests.request import Request, positional, word


class ListRequest(Request):
    """Kinds of things with a name."""

    kind: str | None = positional("KIND", f"One of {', '.join(LISTABLE)}.", None)
    verbose: bool = word(False, "With options and references.", "--verbose", "-v")


class CheckRequest(Request):
    """A plugin to be checked."""

    plugin: str = positional("PLUGIN", "A method's name, or the path of its file.")


class CollectRequest(Request):
    """What the store may forget."""

    older_than: float | None = word(None, "Remove what was not used for so long.", metavar="DAYS", ge=0)
    larger_than: float | None = word(None, "Remove the longest unused beyond this size.", metavar="GIB", ge=0)
