"""Damage to a calibration file, drawn from a seed: what a disk, an editor or an adversary does to it."""

from __future__ import annotations

import re
from collections.abc import Callable

import numpy as np

NUMBERS = [
    "1e999",
    "-1e999",
    "nan",
    ".nan",
    ".Inf",
    "-1",
    "0",
    "1e308",
    "1e-320",
    "9" * 400,
    "''",
    "null",
    "0x1F",
]
FRAGMENTS = [
    *(
        "!!python/object/apply:os.system ['true']",
        "!!binary |",
        "!!opencv-matrix",
        "$base64$",
        "!!set {a, b}",
    ),
    *("&a", "*a", "&a [*a]", "<<: *a", "? ", "- ", ": ", "%YAML:1.0\n", "---\n", "...\n", "|", ">", "#", "@"),
    *("<!DOCTYPE x [<!ENTITY a 'aa'>]>", "&a;", "&amp;", "<![CDATA[", "]]>", "<a>", "</a>", "<_>", "<!--"),
    *(
        "[",
        "]",
        "{",
        "}",
        '"',
        "'",
        ",",
        ":",
        "\\",
        "\\u0000",
        "\\ud800",
        "\0",
        "\t",
        "\r",
        "\x1b",
        "\ufeff",
        "é",
    ),
    *("true", "rows: 3", "cols: 99999999", "cam2:", "data:", "dt: 9999d"),
]
DEEP = ["[", "{a: ", '{"a":', "- ", "<a>", "((", "? ", "!a "]

Mutation = Callable[[str, np.random.Generator], str]


def pick(rng: np.random.Generator, choices: list[str]) -> str:
    return choices[rng.integers(len(choices))]


def cut_short(text: str, rng: np.random.Generator) -> str:
    return text[: rng.integers(len(text) + 1)]


def bytes_flipped(text: str, rng: np.random.Generator) -> str:
    content = bytearray(text.encode())
    for _ in range(rng.integers(1, 9)):
        if content:
            content[rng.integers(len(content))] = rng.integers(256)
    return content.decode("latin-1")


def line_lost(text: str, rng: np.random.Generator) -> str:
    lines = text.splitlines(keepends=True)
    start = rng.integers(len(lines) + 1)
    return "".join(lines[:start] + lines[start + rng.integers(1, 4) :])


def line_repeated(text: str, rng: np.random.Generator) -> str:
    lines = text.splitlines(keepends=True)
    place = rng.integers(len(lines))
    return "".join(lines[:place] + lines[place : place + 1] * rng.integers(2, 5) + lines[place + 1 :])


def number_changed(text: str, rng: np.random.Generator) -> str:
    numbers = list(re.finditer(r"-?\d{1,20}(\.\d*)?(e[+-]?\d+)?", text))
    if not numbers:
        return text
    for found in sorted(rng.choice(len(numbers), min(len(numbers), rng.integers(1, 4))), reverse=True):
        start, end = numbers[found].span()
        text = text[:start] + pick(rng, NUMBERS) + text[end:]
    return text


def number_lost(text: str, rng: np.random.Generator) -> str:
    numbers = list(re.finditer(r"-?\d{1,20}\.\d*(e[+-]?\d+)?,? ?", text))
    if not numbers:
        return text
    start, end = numbers[rng.integers(len(numbers))].span()
    return text[:start] + text[end:]


def all_numbers(text: str, rng: np.random.Generator) -> str:
    return re.sub(r"-?\d{1,20}\.\d*(e[+-]?\d+)?", pick(rng, NUMBERS), text)


def fragment_put_in(text: str, rng: np.random.Generator) -> str:
    place = rng.integers(len(text) + 1)
    return text[:place] + pick(rng, FRAGMENTS) + text[place + rng.integers(0, 3) :]


def nested_deeply(text: str, rng: np.random.Generator) -> str:
    place = rng.integers(len(text) + 1)
    return text[:place] + pick(rng, DEEP) * int(rng.choice([50, 500, 5000])) + text[place:]


def piece_repeated(text: str, rng: np.random.Generator) -> str:
    start = rng.integers(len(text) + 1)
    piece = text[start : start + rng.integers(1, 40)]
    return text[:start] + piece * int(rng.choice([2, 10, 1000])) + text[start:]


def piece_moved(text: str, rng: np.random.Generator) -> str:
    start, end, place = np.sort(rng.integers(len(text) + 1, size=3))
    return text[:start] + text[end:place] + text[start:end] + text[place:]


MUTATIONS: list[Mutation] = [
    cut_short,
    bytes_flipped,
    line_lost,
    line_repeated,
    number_changed,
    number_changed,
    number_lost,
    all_numbers,
    fragment_put_in,
    fragment_put_in,
    nested_deeply,
    piece_repeated,
    piece_moved,
]


def damaged(text: str, rng: np.random.Generator) -> bytes:
    """`text` after one to three mutations."""
    for _ in range(rng.integers(1, 4)):
        if text:
            text = MUTATIONS[rng.integers(len(MUTATIONS))](text, rng)
    return text.encode(("utf-8", "latin-1")[rng.integers(2)], "replace")
