"""Tables, figures and the HTML page of a run."""

from rectbench.reporting.report import write_report
from rectbench.reporting.sources import Sources

__all__ = ["Sources", "write_report"]
