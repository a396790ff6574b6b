"""Plain data as YAML that people read and edit."""

from __future__ import annotations

from typing import Any

import yaml

LONGEST_LINE = 100
LONGEST_PLAIN_TEXT = 70
"""Characters of a string; a longer one is folded."""


def yaml_text(content: Any) -> str:
    """Blocks for mappings and for matrices, a line for a list of numbers, folded prose.

    >>> print(yaml_text({"name": "mine", "t": [0.1, 0.0, 0.0], "R": [[1, 0], [0, 1]]}))
    name: mine
    t: [0.1, 0.0, 0.0]
    R:
    - [1, 0]
    - [0, 1]
    <BLANKLINE>
    """
    text: str = yaml.dump(content, Dumper=_Dumper, sort_keys=False, width=LONGEST_LINE, allow_unicode=True)
    return text


class _Dumper(yaml.SafeDumper):
    def ignore_aliases(self, data: Any) -> bool:
        return True

    def represent_sequence(
        self, tag: str, sequence: Any, flow_style: bool | None = None
    ) -> yaml.SequenceNode:
        return super().represent_sequence(tag, sequence, not any(isinstance(item, list) for item in sequence))

    def represent_str(self, data: str) -> yaml.ScalarNode:
        style = ">" if len(data) > LONGEST_PLAIN_TEXT else None
        return self.represent_scalar("tag:yaml.org,2002:str", data, style)


_Dumper.add_representer(str, _Dumper.represent_str)
