"""The two pictures of a rig, 8 bits of sRGB each, rendered or photographed."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from rectbench.cameras import Camera
from rectbench.errors import InvalidInput
from rectbench.images.reading import encoded, read_colours
from rectbench.rigs.rig import Rig

Image = NDArray[np.uint8]


def check_size(image: NDArray[np.generic], camera: Camera, name: str, whose: str) -> None:
    """Raise InvalidInput, which calls the image and the camera so, where it has not the camera's size."""
    if image.ndim not in (2, 3) or image.shape[1::-1] != camera.size:
        size = "x".join(map(str, image.shape[1::-1]))
        expected = f"{camera.width}x{camera.height}, the size of {whose}"
        raise InvalidInput(f"{name} is {size} px; expected {expected}")


@dataclass(frozen=True, eq=False)
class StereoPair:
    """The images of a rig: `left`, `right` uint8 sRGB [H, W, 3], each of its camera's size.

    Raises InvalidInput for an array that is no such image.

    >>> import numpy as np
    >>> import rectbench as rb
    >>> black = np.zeros((480, 640, 3), np.uint8)
    >>> rb.StereoPair(black, black).check(rb.load_rig("t265"))
    Traceback (most recent call last):
    ...
    rectbench.errors.InvalidInput: left image is 640x480 px; expected 848x800, the size of rig t265's camera
    """

    left: Image
    right: Image

    def __post_init__(self) -> None:
        for side in ("left", "right"):
            image = np.asarray(getattr(self, side))
            if image.dtype != np.uint8 or image.ndim != 3 or image.shape[2] != 3 or image.size == 0:
                raise InvalidInput(f"{side} image is {image.dtype} {image.shape}; expected uint8 [H, W, 3]")
            object.__setattr__(self, side, image)

    def check(self, rig: Rig) -> None:
        """Raise InvalidInput where an image's size is not its camera's."""
        for side in ("left", "right"):
            check_size(getattr(self, side), getattr(rig, side), f"{side} image", f"rig {rig.name}'s camera")

    def save(self, folder: str | Path) -> None:
        """Write left.png and right.png into a folder, which is made where it does not exist."""
        folder = Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        for side in ("left", "right"):
            (folder / f"{side}.png").write_bytes(encoded(getattr(self, side)))

    @classmethod
    def load(cls, folder: str | Path, rig: Rig | None = None) -> StereoPair:
        """Read left.png and right.png of a folder; with a rig, their sizes are checked against it."""
        return cls.read(Path(folder) / "left.png", Path(folder) / "right.png", rig)

    @classmethod
    def read(cls, left: str | Path, right: str | Path, rig: Rig | None = None) -> StereoPair:
        """Read two image files; with a rig, their sizes are checked against it."""
        pair = cls(read_colours(left), read_colours(right))
        if rig is not None:
            pair.check(rig)
        return pair
