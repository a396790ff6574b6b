"""What the run of a report takes, on the command line, in Python, and in a TOML file beside the report; and
what is asked of its design.

[run]
methods = ["abraham", "mine.py"]
jobs = 2

[methods.conventional]
focal = "fov"
"""

from __future__ import annotations

import tomllib
from collections.abc import Collection, Mapping
from numbers import Integral
from pathlib import Path
from typing import Annotated, Any

from pydantic import ConfigDict, StrictBool, model_validator

from rectbench.applications.requests.request import Margin, Request, Text, number, positional, word
from rectbench.applications.requests.words import (
    OptionSets,
    listed,
    option_sets_in,
    share_in,
    whole_numbers_in,
)
from rectbench.errors import InvalidInput, UnknownName

Jobs = Annotated[int, number(Integral, "a whole number from 1 on", lambda n: n >= 1)]


def _names(text: str) -> Any:
    return word(text, metavar="NAMES", parse=listed, has_commas=True)


class RunRequest(Request):
    """A report to be run, and what of it."""

    report: Any = positional("REPORT", "A report's name, or the path of its file.")
    out: Path | None = word("The run's folder; runs/REPORT by default.")
    methods: list[Text] | None = _names("Run these in the place of the report's own, +NAME beside them.")
    scenes: list[Text] | None = _names("Likewise.")
    rigs: list[Text] | None = _names("Likewise.")
    seeds: list[Any] | None = word(
        "Likewise, such as 0,1,2.", metavar="NUMBERS", parse=whole_numbers_in, has_commas=True
    )
    data: Path | None = word("Photographs, for a report that takes them.", metavar="FOLDER")
    jobs: Jobs | None = word("Worker processes; one a core by default.")
    dask: str | None = word("Run on this dask scheduler's cluster.", metavar="ADDRESS")
    fresh: StrictBool = word("Make again what the store has of this run.", default=False)
    margin_deg: Margin | None = word(
        "Nearer to the epipoles than this views are trimmed; the report's own by default.", metavar="DEGREES"
    )
    config: Path | None = word("TOML with [run] and [methods.NAME]; the command line wins.")
    options: OptionSets = word(
        "An option of a method; repeatable.",
        "--option",
        default={},
        metavar="METHOD.NAME=VALUE",
        parse=option_sets_in,
    )

    @model_validator(mode="before")
    @classmethod
    def _over_config(cls, given: dict[str, Any]) -> dict[str, Any]:
        """What is given, laid over the settings of the file `config`, which are checked as they are."""
        path = given.get("config")
        if path is None:
            return given
        settings, options = _in_file(Path(path), cls.model_fields.keys() - {"report", "config", "options"})
        try:
            cls(report=given.get("report"), **settings)
        except InvalidInput as error:
            raise InvalidInput(f"{path}: {error}") from None
        return {**settings, **given, "options": overlaid(options, option_sets_in(given.get("options")))}


class PlanRequest(Request):
    """A difference that a report is to tell, judged by a run of it that is there."""

    model_config = ConfigDict(validate_default=True)
    report: Any = positional("REPORT", "A report's name, or the path of its file.")
    detect: Any = word("The difference that is to be told.", default="2%", metavar="PERCENT", parse=share_in)
    """A share, once it is checked."""
    metric: str | None = word(
        "The column that is compared, one of `rectbench list metrics`; by default the one that ranks methods."
    )
    run: Path | None = word("The folder of a run of the report; runs/REPORT by default.", metavar="FOLDER")


def overlaid(*layers: OptionSets) -> OptionSets:
    """Option sets of which later ones win."""
    merged: OptionSets = {}
    for layer in layers:
        for method, options in layer.items():
            merged[method] = {**merged.get(method, {}), **options}
    return merged


def _in_file(path: Path, run_keys: Collection[str]) -> tuple[dict[str, Any], OptionSets]:
    """The `[run]` keys and the options by method of a TOML file; their values are for the request to check.

    Raises InvalidInput for a file that cannot be read, UnknownName for a key that does not exist.
    """
    try:
        document = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InvalidInput(f"{path} cannot be read: {error.strerror}") from None
    except ValueError as error:
        raise InvalidInput(f"{path} is no TOML: {error}") from None
    _only(path, "section", document, ("run", "methods"))
    settings, methods = document.get("run", {}), document.get("methods", {})
    sections = {"run": settings, "methods": methods}
    if isinstance(methods, dict):
        sections |= {f"methods.{name}": options for name, options in methods.items()}
    for section, values in sections.items():
        if not isinstance(values, dict):
            raise InvalidInput(f"{path}: {section} is {values!r}; expected a section of options [{section}]")
    _only(path, "key of [run]", settings, run_keys)
    return settings, methods


def _only(path: Path, kind: str, given: Mapping[str, Any], known: Collection[str]) -> None:
    for key in given:
        if key not in known:
            raise UnknownName(f"{kind} in {path}", key, known)
