"""What is to be done, as plain values that travel to other processes: a pair, and a cell on it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

IDENTITY = ("report", "scene", "rig", "motion", "pose", "method", "options", "seed")
"""The columns that say which cell a row is; `status` and `reason` follow, then the metrics."""
AS_CALIBRATED = "as-calibrated"
"""The motion of photographs: the rig is what it is."""


@dataclass(frozen=True)
class Cell:
    """Which cell of which report: what its row and its random numbers are named after."""

    report: str
    scene: str
    rig: str
    motion: str
    pose: str
    method: str
    options: str
    """The options given, as canonical JSON; "{}" where all are the method's own."""
    seed: int


@dataclass(frozen=True)
class PairTask:
    """A pair of images to be rendered, and its truth: a rig that stands in a scene."""

    scene: str
    rig: str
    motion: str
    seed: int
    scene_source: str
    """The scene's name, or the absolute path of its file."""
    rig_source: str
    image_width: int | None
    quality: str
    spp: int
    truth: bool
    """Whether anything asks for the truth."""
    images: bool
    """Whether anything asks for the rendered images."""


@dataclass(frozen=True)
class PhotoTask:
    """A pair of photographs, and the calibration of the rig that took them."""

    scene: str
    rig: str
    motion: str
    seed: int
    left: str
    """Absolute paths of the images,"""
    right: str
    calibration: tuple[str, ...]
    """and of the calibration's files."""
    size: tuple[int, int] | None
    """Of the images, where these files leave it out."""
    unit: str | None
    max_angle_deg: float | None
    """The lenses' image circle, where these files leave it out."""
    cameras: tuple[str, str] | None = None
    """The two of files that hold more."""

    @property
    def images(self) -> bool:
        """Photographs are their images."""
        return True

    @staticmethod
    def from_json(values: Mapping[str, Any]) -> PhotoTask:
        """The task of what `asdict` and JSON made of it."""
        size, cameras = values["size"], values["cameras"]
        return PhotoTask(
            **{
                **values,
                "calibration": tuple(values["calibration"]),
                "size": None if size is None else (size[0], size[1]),
                "cameras": cameras and (cameras[0], cameras[1]),
            }
        )


AnyPair = PairTask | PhotoTask


@dataclass(frozen=True)
class CellTask:
    """All that a process needs to know to run one cell, as plain values."""

    cell: Cell
    pair: AnyPair
    method_source: str
    options: dict[str, Any]
    metrics: tuple[str, ...]
    match_count: int
    match_noise_px: float
    group: str = ""
    """The part of the report it belongs to."""
    alone: bool = False
    """Whether it runs with the machine to itself."""

    def to_json(self) -> dict[str, Any]:
        """As JSON values."""
        return asdict(self)

    @staticmethod
    def from_json(values: Mapping[str, Any]) -> CellTask:
        """The task that `to_json` wrote."""
        pair = values["pair"]
        return CellTask(
            **{
                **values,
                "cell": Cell(**values["cell"]),
                "pair": PhotoTask.from_json(pair) if "calibration" in pair else PairTask(**pair),
                "metrics": tuple(values["metrics"]),
            }
        )
