"""What the verbs of a report and its runs take."""

from __future__ import annotations

from numbers import Integral
from pathlib import Path
from typing import Annotated, Any

from pydantic import BeforeValidator, Field, model_validator

from rectbench.applications.requests.config_file import overlaid, read_config
from rectbench.applications.requests.request import LISTED, Request, Word, number, positional
from rectbench.applications.requests.shared import Names
from rectbench.applications.requests.words import OptionSets, option_sets_in, whole_numbers_in
from rectbench.errors import InvalidInput

RunFolder = Annotated[Path, positional("RUN"), Field(description="A run's folder.")]


class RunRequest(Request):
    """A report to be run, and what of it."""

    report: Annotated[
        Any, positional("REPORT"), Field(description="A report's name, or the path of its file.")
    ]
    out: Path | None = Field(None, description="The run's folder; runs/REPORT by default.")
    methods: Names = Field(None, description="Run these in the place of the report's own, +NAME beside them.")
    scenes: Names = Field(None, description="Likewise.")
    rigs: Names = Field(None, description="Likewise.")
    seeds: Annotated[
        list[Any] | None,
        BeforeValidator(whole_numbers_in),
        LISTED,
        Word(metavar="NUMBERS", has_commas=True),
    ] = Field(None, description="Likewise, such as 0,1,2.")
    data: Annotated[Path | None, Word(metavar="FOLDER")] = Field(
        None, description="Photographs, for a report that takes them."
    )
    jobs: Annotated[int | None, number(Integral, "a whole number from 1 on", lambda n: n >= 1)] = Field(
        None, description="Worker processes; one a core by default."
    )
    dask: Annotated[str | None, Word(metavar="ADDRESS")] = Field(
        None, description="Run on this dask scheduler's cluster."
    )
    fresh: bool = Field(False, strict=True, description="Make again what the store has of this run.")
    config: Path | None = Field(
        None, description="TOML with [run] and [methods.NAME]; the command line wins."
    )
    options: Annotated[
        OptionSets, BeforeValidator(option_sets_in), Word(("--option",), metavar="METHOD.NAME=VALUE")
    ] = Field({}, description="An option of a method; repeatable.")

    @model_validator(mode="before")
    @classmethod
    def _over_config(cls, given: dict[str, Any]) -> dict[str, Any]:
        """What is given, laid over the settings of the file `config`, which are checked as they are."""
        path = given.get("config")
        if path is None:
            return given
        settings, options = read_config(Path(path), cls.model_fields.keys() - {"report", "config", "options"})
        try:
            cls(report=given.get("report"), **settings)
        except InvalidInput as error:
            raise InvalidInput(f"{path}: {error}") from None
        return {**settings, **given, "options": overlaid(options, option_sets_in(given.get("options")))}


class ReportRequest(Request):
    """A run whose page is to be written again."""

    folder: RunFolder


class GateRequest(Request):
    """A run that is compared with accepted numbers, or accepted."""

    folder: RunFolder
    accepted: Path | None = Field(
        None, description="The accepted numbers; beside the report's file by default."
    )
    accept: bool = Field(False, description="Make the run's numbers the accepted ones.")


class CompareRequest(Request):
    """Two runs."""

    a: Annotated[Path, positional("A"), Field(description="A run's folder.")]
    b: Annotated[Path, positional("B"), Field(description="Another.")]
    metrics: Names = Field(None, description="Only these columns.")
