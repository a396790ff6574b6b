"""What the files of tables and figures are called."""

from __future__ import annotations

import re

from rectbench.plugins.result import Part


def slug(*parts: str) -> str:
    """A file's stem from names: lower case, hyphens, nothing a shell or LaTeX minds."""
    return "-".join(filter(None, (re.sub(r"[^a-z0-9]+", "-", part.lower()).strip("-") for part in parts)))


def named(part: Part, stem: str, *parts: str) -> str:
    """A file's stem that holds the name of the report's part, once."""
    return slug(stem, "" if part.group == stem else part.group, *parts)
