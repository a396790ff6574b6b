"""librealsense's intrinsics, however they are written, as a camera (rs2_project_point_to_pixel, rsutil.h)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from rectbench.calibrations.assembling import Pair, camera_of
from rectbench.calibrations.documents import Section, shown
from rectbench.cameras import Camera
from rectbench.errors import InvalidInput

PAIRS = (("fisheye 1", "fisheye 2"), ("infrared 1", "infrared 2"))
"""Streams that are a stereo pair, left first."""

COEFFICIENTS = 5
BROWN = ("k1", "k2", "p1", "p2", "k3")
NO_PREFIX = ("distortion.", "rs2 distortion ")
"""What pyrealsense2 and C put before the names of distortions."""

PLAIN = ("None", "Brown Conrady", "Modified Brown Conrady", "Inverse Brown Conrady")
"""Distortions that without coefficients are none."""

DISTORTIONS = (*PLAIN, "Kannala Brandt4", "Ftheta")


def stereo_pairs(names: Iterable[str]) -> list[Pair]:
    """The stereo pairs among the streams."""
    spelt = {_spelt(name): name for name in names}
    return [(spelt[left], spelt[right]) for left, right in PAIRS if left in spelt and right in spelt]


def _spelt(word: str) -> str:
    """A name in small letters, with the spaces that some write as underscores."""
    return word.replace("_", " ").lower()


def realsense_camera(section: Section, keys: Sequence[str], size: tuple[int, int]) -> Camera:
    """The camera of a stream; `keys` are those of fx, fy, ppx, ppy, the distortion and its coefficients."""
    *focal, kind_key, coefficients_key = keys
    params = {
        ours: section.number(theirs, "pixels")
        for ours, theirs in zip(("fx", "fy", "cx", "cy"), focal, strict=True)
    }
    coefficients = section.numbers(coefficients_key, "five distortion coefficients", COEFFICIENTS)
    model, distortion = _distortion(section, kind_key, coefficients)
    return camera_of(section.where, model, size, params | distortion)


def _distortion(section: Section, key: str, coefficients: list[float]) -> tuple[str, dict[str, float]]:
    word = _spelt(section.text(key, f"one of {', '.join(DISTORTIONS)}"))
    for prefix in NO_PREFIX:
        word = word.removeprefix(prefix)
    kind = next((name for name in DISTORTIONS if name.lower() == word), "")
    if not kind:
        raise section.fault(key, ", ".join(DISTORTIONS))
    *first, last = coefficients
    if kind == "Kannala Brandt4" and last == 0:
        return "kannala-brandt", dict(zip(("k1", "k2", "k3", "k4"), first, strict=True))
    if kind == "Ftheta" and not any(coefficients[1:]):
        return "field-of-view", {"omega": coefficients[0]}
    if kind in PLAIN and not any(coefficients):
        return "pinhole", {}
    is_radial = not any(coefficients[2:4])
    if kind == "Brown Conrady" or (kind == "Modified Brown Conrady" and is_radial):
        return "pinhole", dict(zip(BROWN, coefficients, strict=True))
    raise InvalidInput(
        f"{section.at(key)} is {kind} with {shown(coefficients)}, a lens that rectbench has not; "
        "expected Kannala Brandt4, Brown Conrady, or coefficients of 0"
    )
