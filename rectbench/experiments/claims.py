"""Claims, stated before a run: which column, which method, against whom, within which bounds."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

Verdict = Literal["held", "not held", "depends", "undecided", "not measured"]
"""What a run says of a claim. `depends`: ways to measure the same thing answer differently. `undecided`: the
run is too small to say, or cells of it failed; more rigs would tell."""

Measure = Literal["value", "ratio", "count", "share"]

_ONLY_FOR: Mapping[str, tuple[Measure, ...]] = {
    "rivals": ("count",),
    "of": ("count",),
    "against": ("ratio", "share"),
    "within": ("share",),
}


class Statement(BaseModel):
    """One measurable sentence of a claim: a quantity, and the bounds within which the sentence is true.

    >>> Statement(label="fit [s]", metric="fit_s", method="abraham", below=3.0).expected
    '≤ 3'
    >>> rivals = {"method": "abraham", "rivals": ("conventional",)}
    >>> Statement(label="least", metric="fit_s", measure="count", above=3, of=4, **rivals).expected
    '≥ 3 of 4'
    """

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)

    label: str
    """What is measured, under which protocol."""
    clause: str = ""
    """The part of the claim that it measures."""
    group: str = ""
    """The part of the report it speaks of."""
    metric: str
    """A column of the rows."""
    over: str | None = None
    """A column of the same rows that the first is divided by."""
    method: str
    options: Mapping[str, Any] = Field(default_factory=dict)
    """Options its rows have, at least."""
    against: str | None = None
    """The method it is compared with."""
    against_options: Mapping[str, Any] = Field(default_factory=dict)
    """Options that one's rows have, at least."""
    against_group: str | None = None
    """Where that one's rows are, if elsewhere."""
    rivals: tuple[str, ...] = ()
    """The methods that it has to be less than, whatever their options. A rival without a number, because its
    image does not show that much, is none that is less; a rig without any rival's number says nothing."""
    measure: Measure = "value"
    """The mean; the geometric mean of the ratio to `against`; the number of rigs on which the method has less
    than each of `rivals`; the share of cells whose ratio is within `within`. Each is taken over rigs, of
    the mean over a rig's motions of that over scenes of that over seeds."""
    within: tuple[float, float] | None = None
    above: float | None = None
    """True where the quantity is at least this."""
    below: float | None = None
    """True where the quantity is at most this."""
    of: int | None = None
    """Of how many rigs `above` is a count: 3 of 4 is claimed of 6 of 8, too."""
    judges: bool = True
    """Whether the claim stands on it; else it stands beside it, to compare with."""

    @model_validator(mode="after")
    def _can_be_false(self) -> Statement:
        if self.above is None and self.below is None:
            raise ValueError(f"statement '{self.label}' has neither above nor below; expected a bound")
        least, most = self.bounds
        if not least <= most:
            raise ValueError(f"statement '{self.label}' is true from {least} to {most}; expected a range")
        for name, measures in _ONLY_FOR.items():
            if bool(getattr(self, name)) != (self.measure in measures):
                where = " and ".join(measures)
                raise ValueError(f"statement '{self.label}' is a {self.measure}; `{name}` is for {where}")
        if self.of is not None and not (self.above and self.below is None and self.above <= self.of):
            raise ValueError(
                f"statement '{self.label}' is true of {self.above} of {self.of} rigs; expected a count above "
                "0 and at most as many"
            )
        return self

    @property
    def bounds(self) -> tuple[float, float]:
        """Least and greatest value for which the statement is true; of a count, shares of the rigs."""
        rigs = self.of or 1
        return (
            -math.inf if self.above is None else self.above / rigs,
            math.inf if self.below is None else self.below,
        )

    @property
    def speaks_of(self) -> list[tuple[str, str]]:
        """The groups and methods whose rows it needs."""
        elsewhere = self.group if self.against_group is None else self.against_group
        rivals = (*self.rivals, *([] if self.against is None else [self.against]))
        return [(self.group, self.method), *((elsewhere, rival) for rival in rivals)]

    @property
    def expected(self) -> str:
        """The bounds in words."""
        if self.of is not None:
            return f"≥ {self.above:g} of {self.of}"
        if self.above is not None and self.below is not None:
            return f"{self.above:g} to {self.below:g}"
        return f"≥ {self.above:g}" if self.above is not None else f"≤ {self.below:g}"


class Claim(BaseModel):
    """What somebody says, as statements that can be measured, and what each verdict would mean.

    >>> quick = Statement(label="fit [s]", metric="fit_s", method="abraham", below=3.0)
    >>> Claim(name="Time", says="It is quick.", statements=(quick,), because={"held": "A formula is."}).name
    'Time'
    """

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)

    name: str
    says: str
    """The claim in a sentence."""
    statements: tuple[Statement, ...]
    because: Mapping[Verdict, str]
    """One sentence why, for each verdict it may get. Of `undecided` the run itself says why."""

    @model_validator(mode="after")
    def _stands_on_something(self) -> Claim:
        if not any(statement.judges for statement in self.statements):
            raise ValueError(f"claim '{self.name}' has no statement that judges it; expected one")
        return self


class SourcePart(BaseModel):
    """An experiment, figure or option of what a report repeats, and what became of it.

    >>> SourcePart(name="SURF features", status="changed", why="SIFT: SURF is patented.").status
    'changed'
    """

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)

    name: str
    """What it is, and where in the source."""
    status: Literal["done", "changed", "impossible"]
    why: str
    """Where it is to be found here, or why it is another thing, or none."""
