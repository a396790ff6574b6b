"""What the verbs of a report and its runs take."""

from __future__ import annotations

from numbers import Integral
from pathlib import Path
from typing import Annotated, Any

from pydantic import model_validator

from rectbench.applications.requests.config_file import overlaid, read_config
from rectbench.applications.requests.request import Request, listed, number, positional, word
from rectbench.applications.requests.shared import Text
from rectbench.applications.requests.words import OptionSets, option_sets_in, whole_numbers_in
from rectbench.errors import InvalidInput

Jobs = Annotated[int, number(Integral, "a whole number from 1 on", lambda n: n >= 1)]


def _names(text: str) -> Any:
    return word(None, text, metavar="NAMES", parse=listed, has_commas=True)


class RunRequest(Request):
    """A report to be run, and what of it."""

    report: Any = positional("REPORT", "A report's name, or the path of its file.")
    out: Path | None = word(None, "The run's folder; runs/REPORT by default.")
    methods: list[Text] | None = _names("Run these in the place of the report's own, +NAME beside them.")
    scenes: list[Text] | None = _names("Likewise.")
    rigs: list[Text] | None = _names("Likewise.")
    seeds: list[Any] | None = word(
        None, "Likewise, such as 0,1,2.", metavar="NUMBERS", parse=whole_numbers_in, has_commas=True
    )
    data: Path | None = word(None, "Photographs, for a report that takes them.", metavar="FOLDER")
    jobs: Jobs | None = word(None, "Worker processes; one a core by default.")
    dask: str | None = word(None, "Run on this dask scheduler's cluster.", metavar="ADDRESS")
    fresh: bool = word(False, "Make again what the store has of this run.", strict=True)
    config: Path | None = word(None, "TOML with [run] and [methods.NAME]; the command line wins.")
    options: OptionSets = word(
        {},
        "An option of a method; repeatable.",
        "--option",
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
        settings, options = read_config(Path(path), cls.model_fields.keys() - {"report", "config", "options"})
        try:
            cls(report=given.get("report"), **settings)
        except InvalidInput as error:
            raise InvalidInput(f"{path}: {error}") from None
        return {**settings, **given, "options": overlaid(options, option_sets_in(given.get("options")))}


class ReportRequest(Request):
    """A run whose page is to be written again."""

    folder: Path = positional("RUN", "A run's folder.")


class GateRequest(Request):
    """A run that is compared with accepted numbers, or accepted."""

    folder: Path = positional("RUN", "A run's folder.")
    accepted: Path | None = word(None, "The accepted numbers; beside the report's file by default.")
    accept: bool = word(False, "Make the run's numbers the accepted ones.")


class CompareRequest(Request):
    """Two runs."""

    a: Path = positional("A", "A run's folder.")
    b: Path = positional("B", "Another.")
    metrics: list[Text] | None = _names("Only these columns.")
