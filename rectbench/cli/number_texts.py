"""Numbers as the words of a command line have them; an error says what was expected."""

from __future__ import annotations

from rectbench.cli.app import split_names
from rectbench.errors import InvalidInput


def numbers_in(words: list[str]) -> list[float] | None:
    """The words as numbers; None where one is none."""
    try:
        return [float(word) for word in words]
    except ValueError:
        return None


def whole_numbers(name: str, texts: list[str] | None) -> list[int] | None:
    """Whole numbers of repeated options and of comma-separated lists; an error calls them `name`."""
    words = split_names(texts)
    try:
        return None if words is None else [int(word) for word in words]
    except ValueError:
        raise InvalidInput(
            f"{name} are {','.join(words or [])}; expected whole numbers such as 0,1,2"
        ) from None


def two_numbers(text: str | None, name: str, expected: str) -> tuple[float, float] | None:
    """Two numbers with an x between them, such as 100x80."""
    if text is None:
        return None
    numbers = numbers_in(text.lower().replace("×", "x").split("x"))
    if numbers is None or len(numbers) != 2:
        raise InvalidInput(f"{name} is {text}; expected {expected}")
    return numbers[0], numbers[1]


def image_size(text: str | None) -> tuple[int, int] | None:
    """(width, height) in whole pixels, such as 1280x800."""
    sides = two_numbers(text, "size", "width and height such as 1280x800")
    if sides is None:
        return None
    if any(side != round(side) for side in sides):
        raise InvalidInput(f"size is {text}; expected whole pixels")
    return round(sides[0]), round(sides[1])
