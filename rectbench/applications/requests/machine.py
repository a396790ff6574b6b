"""What the verbs about this machine and its plugins take."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from rectbench.applications.listing import LISTABLE
from rectbench.applications.requests.request import Request, Word, positional


class ListRequest(Request):
    """Kinds of things with a name."""

    kind: Annotated[str | None, positional("KIND")] = Field(
        None, description=f"One of {', '.join(LISTABLE)}."
    )
    verbose: Annotated[bool, Word(("--verbose", "-v"))] = Field(
        False, description="With options and references."
    )


class CheckRequest(Request):
    """A plugin to be checked."""

    plugin: Annotated[
        str, positional("PLUGIN"), Field(description="A method's name, or the path of its file.")
    ]


class CollectRequest(Request):
    """What the store may forget."""

    older_than: Annotated[float | None, Word(metavar="DAYS")] = Field(
        None, ge=0, description="Remove what was not used for so long."
    )
    larger_than: Annotated[float | None, Word(metavar="GIB")] = Field(
        None, ge=0, description="Remove the longest unused beyond this size."
    )
