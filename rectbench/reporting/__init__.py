"""What reads a finished run: its tables, figures and page. Imports runs and what is below."""

from rectbench.reporting.report import write_report

__all__ = ["write_report"]
