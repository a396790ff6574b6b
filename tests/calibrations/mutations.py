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
    *("!!python/name:os.system", "!!python/tuple", "%TAG ! tag:yaml.org,2002:python/", "!!merge <<"),
    *("[a.b.c]\n", "[[a]]\n", "a = 1\n", '"""', "'''", "=", "]]", "\x85", "\u2028", "\u202e", "\U0001f4f7"),
    *("\uff11\uff12", "\u0663", "1_0", "+.5", "0x1p3", "1e", "--1", "1,5", "-0.0", "NaN", "Infinity"),
]
VALUES = [
    "null",
    "~",
    "true",
    "[]",
    "{}",
    "''",
    "[[]]",
    "[1]",
    "{a: 1}",
    '{"a": 1}',
    "word",
    "1e999",
    "[nan]",
]
DEEP = ["[", "{a: ", '{"a":', "- ", "<a>", "((", "? ", "!a ", "&a [", "a.", "[a.", '"a".']
LEVELS = 12
BOMBS = [
    "a0: &a0 [x, x]\n"
    + "".join(f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 9)}]\n" for n in range(1, LEVELS)),
    "a: &a [*a, *a]\n",
    "<!DOCTYPE a [<!ENTITY b0 'bb'>"
    + "".join(f"<!ENTITY b{n} '{f'&b{n - 1};' * 9}'>" for n in range(1, LEVELS))
    + f"]><a>&b{LEVELS - 1};</a>",
    "<!DOCTYPE a [<!ENTITY b SYSTEM 'file:///dev/zero'>]><a>&b;</a>",
    '{"a": ' * 2000,
    "k" * 5000 + ": 1\n",
    "n: " + "9" * 5000 + "\n",
]
"""What is short and unfolds, or is followed, to something without end."""

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


def value_replaced(text: str, rng: np.random.Generator) -> str:
    """What follows a key becomes of another kind."""
    places = list(re.finditer(r"[:=][ \t]*[^\s,}]{1,40}", text))
    if not places:
        return text
    start, end = places[rng.integers(len(places))].span()
    return f"{text[: start + 1]} {pick(rng, VALUES)}{text[end:]}"


def number_doubled(text: str, rng: np.random.Generator) -> str:
    """A list or a matrix becomes longer by one."""
    numbers = list(re.finditer(r"-?\d{1,20}\.\d*(e[+-]?\d+)?(,? ?)", text))
    if not numbers:
        return text
    found = numbers[rng.integers(len(numbers))]
    return text[: found.start()] + found[0] + ((found[2] and found[0]) or ", 1.0") + text[found.end() :]


def key_repeated(text: str, rng: np.random.Generator) -> str:
    """A key comes a second time, with another value."""
    keys = list(re.finditer(r'"?[\w.]{1,40}"?[ \t]*[:=]', text))
    if not keys:
        return text
    key = keys[rng.integers(len(keys))]
    return (
        f"{text[: key.start()]}{key[0]} {pick(rng, VALUES)}{pick(rng, [',', chr(10)])} {text[key.start() :]}"
    )


def bomb_put_in(text: str, rng: np.random.Generator) -> str:
    lines = text.splitlines(keepends=True)
    place = rng.integers(len(lines) + 1)
    return "".join(lines[:place]) + pick(rng, BOMBS) + "".join(lines[place:])


def blown_up(text: str, rng: np.random.Generator) -> str:
    """A piece again and again, up to the largest file that is read and beyond."""
    start = rng.integers(len(text) + 1)
    piece = text[start : start + rng.integers(1, 80)]
    return (
        text[:start]
        + piece * (int(rng.choice([1 << 16, 1 << 20, 5 << 20])) // max(1, len(piece)))
        + text[start:]
    )


def lines_ended(text: str, rng: np.random.Generator) -> str:
    """Line ends of another system, or a byte-order mark before the text."""
    ends = ["\r\n", "\r", "\n\r", "\n\n"]
    return "\ufeff" + text if rng.integers(2) else text.replace("\n", pick(rng, ends))


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
    value_replaced,
    value_replaced,
    number_doubled,
    key_repeated,
    bomb_put_in,
    lines_ended,
]
RARE = 200
"""Of so many inputs one is blown up to megabytes; such a one takes the time of a hundred others."""

PIECES = [b"nan", b"-1", b"\0" * 8, b"\xff" * 8, b"\0\0\0\0\0\0\xf0\x7f", b"9" * 400, b"\n", b"# ", b"1 2 3 "]


def damaged(content: bytes, rng: np.random.Generator) -> bytes:
    """A file after one to three mutations."""
    if b"\0" in content:
        return binary_damaged(content, rng)
    text = content.decode()
    for _ in range(rng.integers(1, 4)):
        if text:
            text = MUTATIONS[rng.integers(len(MUTATIONS))](text, rng)
    if rng.integers(RARE) == 0:
        text = blown_up(text, rng)
    encoding = ("utf-8", "utf-8", "utf-8", "latin-1", "utf-16")[rng.integers(5)]
    return text.encode(encoding, "replace")


def binary_damaged(content: bytes, rng: np.random.Generator) -> bytes:
    """A binary file cut short, with bits flipped, a piece put in, doubled or lost, one to three times."""
    for _ in range(rng.integers(1, 4)):
        start = int(rng.integers(len(content) + 1))
        end = start + int(rng.choice([0, 1, 4, 8, 60]))
        kind = rng.integers(5)
        if kind == 0:
            content = content[:start]
        elif kind == 1 and content:
            flipped = bytearray(content)
            for place in rng.integers(len(content), size=rng.integers(1, 5)):
                flipped[place] ^= 1 << rng.integers(8)
            content = bytes(flipped)
        else:
            piece = [PIECES[rng.integers(len(PIECES))], content[start:end] * 2, b""][kind % 3]
            content = content[:start] + piece + content[end:]
    return content
