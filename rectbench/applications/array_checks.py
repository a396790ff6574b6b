"""Arrays as Python hands them over: checked, or refused in one line."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from rectbench.errors import InvalidInput
from rectbench.images.stereo_pair import StereoPair, check_size
from rectbench.rigs import Rig
from rectbench.types import FloatArray, Images, Matches


def checked_rig(rig: object) -> Rig:
    """The rig; what is none says where rigs come from."""
    if not isinstance(rig, Rig):
        raise InvalidInput(f"rig is {type(rig).__name__}; expected a Rig, see rectbench.load_rig")
    return rig


def checked_pixels(pixels: ArrayLike, name: str) -> FloatArray:
    """[N, 2] finite pixels; an error calls them `name`."""
    try:
        points = np.asarray(pixels, dtype=np.float64)
    except (TypeError, ValueError):
        raise InvalidInput(f"{name} are no numbers; expected [N, 2] pixels") from None
    if points.ndim != 2 or points.shape[1] != 2 or not len(points):
        raise InvalidInput(f"{name} have shape {points.shape}; expected [N, 2]")
    if not np.isfinite(points).all():
        raise InvalidInput(f"{name} hold NaN or infinity; expected finite pixels")
    return points


def checked_matches(matches: Sequence[ArrayLike]) -> Matches:
    """As many pixels of either image."""
    if not isinstance(matches, Sequence) or len(matches) != 2:
        raise InvalidInput(f"matches {_held(matches)}; expected (left [N, 2], right [N, 2])")
    left, right = (
        checked_pixels(px, f"{side} matches") for px, side in zip(matches, ("left", "right"), strict=True)
    )
    if left.shape != right.shape:
        raise InvalidInput(f"matches have {len(left)} left and {len(right)} right pixels; expected as many")
    return Matches(left, right)


def _held(given: object) -> str:
    return f"hold {len(given)} arrays" if isinstance(given, Sequence) else f"are {type(given).__name__}"


def checked_images(images: StereoPair | Sequence[ArrayLike], rig: Rig) -> Images:
    """Two images of their cameras' sizes."""
    both: Any = (images.left, images.right) if isinstance(images, StereoPair) else images
    if not isinstance(both, Sequence) or len(both) != 2:
        raise InvalidInput(f"images {_held(both)}; expected (left, right)")
    arrays = Images(*map(np.asarray, both))
    for side, image in zip(("left", "right"), arrays, strict=True):
        check_size(image, getattr(rig, side), f"the {side} image", f"rig {rig.name}'s camera")
    return arrays
