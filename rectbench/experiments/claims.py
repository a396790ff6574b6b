"""Claims, stated before a run: which column, which method, against whom, within which bounds."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

Verdict = Literal["held", "not held", "depends", "not measured"]
"""What a run says of a claim."""


class Statement(BaseModel):
    """One measurable sentence of a claim: a quantity, and the bounds within which the sentence is true.

    >>> Statement(label="fit [s]", metric="fit_s", method="abraham", below=3.0).expected
    '≤ 3'
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
    method: str
    options: Mapping[str, Any] = Field(default_factory=dict)
    """Options its rows have, at least."""
    against: str | None = None
    """The method it is compared with."""
    rivals: tuple[str, ...] = ()
    """The methods to win against."""
    against_group: str | None = None
    """Where that one's rows are, if elsewhere."""
    measure: Literal["value", "ratio", "wins", "share"] = "value"
    """The mean; the geometric mean of the ratio to `against`; the number of pairs where the method has
    the least value of all `rivals`; the share of cells whose ratio is within `within`."""
    within: tuple[float, float] | None = None
    above: float | None = None
    """True where the quantity is at least this."""
    below: float | None = None
    """True where the quantity is at most this."""

    @model_validator(mode="after")
    def _can_be_false(self) -> Statement:
        if self.above is None and self.below is None:
            raise ValueError(f"statement '{self.label}' has neither above nor below; expected a bound")
        least, most = self.bounds
        if not least <= most:
            raise ValueError(f"statement '{self.label}' is true from {least} to {most}; expected a range")
        allowed = {"rivals": ["wins"], "against": ["ratio", "share"], "within": ["share"]}
        for name, measures in allowed.items():
            if bool(getattr(self, name)) != (self.measure in measures):
                where = " and ".join(measures)
                raise ValueError(f"statement '{self.label}' is a {self.measure}; `{name}` is for {where}")
        return self

    @property
    def bounds(self) -> tuple[float, float]:
        """Least and greatest value for which the statement is true."""
        return (
            -math.inf if self.above is None else self.above,
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
    statements: tuple[Statement, ...] = Field(min_length=1)
    because: Mapping[Verdict, str]
    """One sentence why, for each verdict it may get."""
