"""The rigs that ship with rectbench, in its own format."""

from __future__ import annotations

from functools import cache
from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path

from rectbench.calibrations.formats.native import read_native
from rectbench.errors import Unavailable, UnknownName
from rectbench.rigs.rig import Rig


def rig_names() -> tuple[str, ...]:
    """The names of the rigs that ship with rectbench, sorted.

    >>> import rectbench as rb
    >>> "t265" in rb.rig_names()
    True
    """
    return tuple(sorted(_files()))


FISHEYE_DEG = 120.0
"""Field of view from which on a lens is called fisheye: 60° from the axis a perspective image shows things
four times as long as in the middle (1 / cos² 60°)."""
CALIBRATED_TWICE = frozenset({"tumvi-kb"})
"""Rigs whose lenses another rig has as well, by another model: as units of a comparison they count once."""
MADE_UP = frozenset({"lens-100", "lens-160", "lens-190", "lens-220"})
"""Ideal fisheye lenses, of which nothing real is a sample."""


def fisheye_rigs(least_fov_deg: float = FISHEYE_DEG) -> tuple[str, ...]:
    """The names of the rigs that ship with rectbench whose two lenses see that far: real ones, each once.

    The field of view is that across the image's diagonal, of the narrower lens.

    >>> import rectbench as rb
    >>> "t265" in rb.fisheye_rigs(), "bumblebee2" in rb.fisheye_rigs()
    (True, False)
    >>> "t265" in rb.fisheye_rigs(least_fov_deg=170)
    False
    """
    lenses = (name for name in rig_names() if name not in CALIBRATED_TWICE | MADE_UP)
    return tuple(name for name in lenses if _reaches(name, least_fov_deg / 2))


@cache
def _reaches(name: str, angle_deg: float) -> bool:
    """Whether both lenses of a rig do; every report about fisheye lenses asks for that of all of them."""
    rig = built_in_rig(name)
    return rig.left.reaches(angle_deg) and rig.right.reaches(angle_deg)


def built_in_rig(name: str) -> Rig:
    """The rig of that name. Raises UnknownName, with the nearest names, where there is none."""
    files = _files()
    if name not in files:
        raise UnknownName("rig", name, files)
    return read_native(f"{name}.yaml", files[name].read_text(encoding="utf-8"))


def may_be_rig_name(source: str) -> bool:
    """Whether a string names a built-in rig; a path has a folder or a suffix, or exists as a file."""
    if Path(source).name != source or Path(source).suffix:
        return False
    return source in _files() or not Path(source).exists()


def _files() -> dict[str, Traversable]:
    try:
        folder = resources.files("rectbench_scenes") / "rigs"
    except ModuleNotFoundError:
        raise Unavailable(
            "the built-in rigs are not installed; expected the package rectbench_scenes"
        ) from None
    return {Path(file.name).stem: file for file in folder.iterdir() if file.name.endswith(".yaml")}
