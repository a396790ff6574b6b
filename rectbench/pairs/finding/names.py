"""Which image files are the left and the right one of a pair, by their names alone, and never by a guess.

Two names belong together where they differ in a word for the side and in nothing else: left and right, l and
r, cam0 and cam1, image_02 and image_03, or a last number, as fs1 and fs2. The word may stand in the file's
name, in that of a folder above it, or in both. What could have two partners has none.
"""

from __future__ import annotations

import itertools
import os
import re
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

Words = tuple[str, ...]
"""A path cut into words and numbers in lower case, "/" between folders; the suffix comes last."""

Neighbours = Mapping[Path, list[Path]]

FOLDER = "/"
FROM_LEFT, FROM_RIGHT = "<left", "<right"
"""The first words of images that the user has said which side they are of."""
CAMERAS = frozenset({"cam", "camera", "sensor", "eye"})
IMAGES = frozenset({"image", "img", "im", "view"})
"""What is counted where a number follows: cameras rather than images, where a name has both."""
LAST_LEFT = 2
"""The largest number of a left camera: KITTI's colour cameras are 2 and 3."""
MASK = "mask"
"""A word in the name of an image that tells where others show anything."""
MOST_SIDES = 6
"""Words for a side in one path that are looked at."""


@dataclass(frozen=True)
class FilePair:
    """Two images of one moment."""

    name: str
    """What the names of both files have in common, words joined by hyphens; empty where that is nothing."""
    left: Path
    right: Path

    @property
    def files(self) -> tuple[Path, Path]:
        """Both."""
        return self.left, self.right


@dataclass(frozen=True)
class LeftOut:
    """A file that was not taken, and why."""

    path: Path
    reason: str


@dataclass(frozen=True)
class Pairing:
    """All the files that were given: each in one pair, or left out."""

    pairs: tuple[FilePair, ...]
    left_out: tuple[LeftOut, ...]


@dataclass(frozen=True)
class _Sides:
    """One way to tell the sides: by two words, or by numbers after a word or at the end of the name."""

    spelled: tuple[str, str] | None = None
    after: frozenset[str] = frozenset()
    in_folders: bool = False
    last: bool = False

    def right_word(self, words: Words, place: int) -> str | None:
        """What stands for the right side where the word at `place` stands for the left one."""
        word = words[place]
        if self.spelled is not None:
            return self.spelled[1] if word == self.spelled[0] else None
        if not word.isdecimal() or not self._counts(words, place):
            return None
        return str(int(word) + 1).zfill(len(word))

    def _counts(self, words: Words, place: int) -> bool:
        if self.last:
            return place == len(words) - 2
        in_folder = FOLDER in words[place:]
        return in_folder == self.in_folders and place > 0 and words[place - 1] in self.after

    def may_begin(self, words: Words) -> bool:
        """Whether these may be a left image's: of numbers only the first few begin a pair."""
        counted = [int(w) for i, w in enumerate(words) if w.isdecimal() and self._counts(words, i)]
        return self.spelled is not None or any(number <= LAST_LEFT for number in counted)


_WAYS = (
    _Sides(("left", "right")),
    _Sides(("l", "r")),
    *(_Sides(after=names, in_folders=above) for above in (True, False) for names in (CAMERAS, IMAGES)),
    _Sides(last=True),
)
"""Tried in turn, each on the files that those before have left."""


def paired_files(files: Iterable[Path], root: Path) -> Pairing:
    """The pairs among image files below the folder `root`, by the order of their left paths.

    A row of more than two numbers is a sequence, or a rig of more cameras, and tells no pair.
    """
    return _paired({file: _words(file.relative_to(root)) for file in sorted(set(files))})


def paired_folders(
    left: Path, right: Path, files_left: Iterable[Path], files_right: Iterable[Path]
) -> Pairing:
    """The pairs of the images in a folder of left ones and a folder of right ones.

    Their names may be the same, or differ in a word for the side.
    """
    sides = ((FROM_LEFT, left, files_left), (FROM_RIGHT, right, files_right))
    return _paired(
        {
            file: (side, FOLDER, *_words(file.relative_to(folder)))
            for side, folder, files in sides
            for file in sorted(set(files))
        }
    )


def home_of(files: Sequence[Path]) -> Path:
    """The folder that holds all the files, in itself or below."""
    return Path(os.path.commonpath([file.parent for file in files]))


def is_mask(image: Path) -> bool:
    """Whether an image is a mask by its name, no photograph."""
    return MASK in words_in(image.stem)


def camera_numbers(pair: FilePair) -> tuple[int, int] | None:
    """Which cameras took a pair, where its names number them and these are not the first two: (2, 3)."""
    left, right = _words(pair.left), _words(pair.right)
    if len(left) != len(right):
        return None
    named = {
        (int(a), int(b))
        for before, a, b in zip(left, left[1:], right[1:], strict=False)
        if a != b and a.isdecimal() and b.isdecimal() and before in CAMERAS | IMAGES
    }
    numbers = named.pop() if len(named) == 1 else (0, 1)
    return numbers if numbers[0] >= LAST_LEFT else None


def _paired(words: Mapping[Path, Words]) -> Pairing:
    free, partner, doubts = dict(words), dict[Path, Path](), dict[Path, list[Path]]()
    for way in _WAYS:
        rights, lefts = _neighbours(free, way)
        near = {file: lefts[file] + rights[file] for file in free}
        for left in [file for file in free if rights[file]]:
            right = rights[left][0]
            if len(near[left]) == len(near[right]) == 1 and way.may_begin(words[left]):
                partner[left] = right
                del free[left], free[right]
        doubts = {file: near[file] for file in free if near[file]} | doubts
    pairs = (FilePair(_common(words[a], words[b]), a, b) for a, b in sorted(partner.items()))
    return Pairing(tuple(pairs), tuple(LeftOut(file, _reason(doubts.get(file, []))) for file in free))


def _neighbours(words: Mapping[Path, Words], way: _Sides) -> tuple[Neighbours, Neighbours]:
    """By file the right images that its name makes it the left one to, and the left ones likewise."""
    named = defaultdict[Words, list[Path]](list)
    for file, its in words.items():
        named[its].append(file)
    rights, lefts = defaultdict[Path, list[Path]](list), defaultdict[Path, list[Path]](list)
    for file, its in words.items():
        for other in _right_names(its, way):
            for right in named.get(other, []):
                rights[file].append(right)
                lefts[right].append(file)
    return rights, lefts


def _right_names(words: Words, way: _Sides) -> Iterator[Words]:
    """The names with the other side in one place or more; where the sides are given, in any or none."""
    if words[0] == FROM_RIGHT:
        return
    if words[0] == FROM_LEFT:
        for rest in (words[1:], *_right_names(words[1:], way)):
            yield (FROM_RIGHT, *rest)
        return
    turned = {i: right for i in range(len(words)) if (right := way.right_word(words, i)) is not None}
    places = list(turned)[:MOST_SIDES]
    for count in range(1, len(places) + 1):
        for chosen in itertools.combinations(places, count):
            yield tuple(turned[i] if i in chosen else word for i, word in enumerate(words))


def _words(path: Path) -> Words:
    words = [word for folder in path.parts[:-1] for word in (*words_in(folder), FOLDER)]
    return *words, *words_in(path.stem), path.suffix.lower()


def words_in(name: str) -> list[str]:
    """The words and numbers that a name is made of, in lower case: "imgL01" is img, l, 01."""
    runs = re.findall(r"\d+|[^\W\d_]+", name)
    capitals = r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|[^A-Za-z]+"
    return [word.lower() for run in runs for word in re.findall(capitals, run)]


def _common(left: Words, right: Words) -> str:
    """The words that the names of both files have; a number stands close to the word before it."""
    below = max((i for i, word in enumerate(left) if word == FOLDER), default=-1) + 1
    words = [a for a, b in zip(left[below:-1], right[below:-1], strict=True) if a == b]
    return "".join(word if not i or word.isdecimal() else f"-{word}" for i, word in enumerate(words))


def _reason(near: list[Path]) -> str:
    if not near:
        return "no other image's name differs from its own in the side alone"
    names = ", ".join("/".join(path.parts[-2:]) for path in near)
    return f"more than one pair is possible: its name goes with {names}, and these or it with others"
