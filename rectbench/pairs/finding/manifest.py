"""`rectbench-data.yaml`: what names and calibration files of a folder of photographs do not tell.

rigs:
  front: {files: [front/chain.yaml], unit: mm, max_angle_deg: 80, cameras: [cam2, cam3]}
pairs:
  - {name: hall, left: a/17.png, right: b/23.png, rig: front}

Both are optional, and so is every key but `files`, `left` and `right`. What is not stated is found as ever.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated

import yaml
from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError, ValidationInfo
from pydantic_core import PydanticCustomError

from rectbench.errors import InvalidInput

MANIFEST = "rectbench-data.yaml"
MOST_BYTES = 1 << 20


def _in_folder(file: Path, info: ValidationInfo[Path]) -> Path:
    """The file in the manifest's folder; links are not followed, so that it stays in the folder it is in."""
    place = Path(os.path.normpath(info.context / file))
    if not place.is_file():
        raise PydanticCustomError("file", "{file}: no such file", {"file": str(file)})
    return place


Place = Annotated[Path, AfterValidator(_in_folder)]


class _Stated(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class StatedRig(_Stated):
    """A calibration by its files, as `load_rig` takes them."""

    files: tuple[Place, ...] = Field(min_length=1)
    unit: str | None = None
    max_angle_deg: float | None = Field(default=None, gt=0, le=180)
    cameras: tuple[str, str] | None = None


class StatedPair(_Stated):
    """Two images that belong together."""

    left: Place
    right: Place
    name: str | None = Field(default=None, min_length=1)
    rig: str | None = None


class Manifest(_Stated):
    """The whole file; its paths are relative to its folder, and absolute once they are read."""

    rigs: dict[str, StatedRig] = Field(default_factory=dict)
    pairs: tuple[StatedPair, ...] = ()

    @property
    def files(self) -> set[Path]:
        """All files that it names."""
        images = {file for pair in self.pairs for file in (pair.left, pair.right)}
        return images.union(*(rig.files for rig in self.rigs.values()))


def read_manifest(folder: Path) -> Manifest:
    """The manifest of a folder, an empty one where it has none.

    Raises InvalidInput in one line that names the file and the key for one that cannot be used.
    """
    path = folder / MANIFEST
    if not path.is_file():
        return Manifest()
    if path.stat().st_size > MOST_BYTES:
        raise InvalidInput(f"{path}: is over {MOST_BYTES >> 20} MiB; expected a list of rigs and pairs")
    try:
        document = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, yaml.YAMLError, RecursionError) as error:
        raise InvalidInput(f"{path}: cannot be read: {' '.join(str(error).split())}") from None
    try:
        manifest = Manifest.model_validate(document or {}, context=folder)
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(map(str, first["loc"])) or "the file"
        raise InvalidInput(f"{path}: {where}: {first['msg']}") from None
    for i, pair in enumerate(manifest.pairs):
        if pair.rig not in (None, *manifest.rigs):
            raise InvalidInput(f"{path}: pairs.{i}.rig is {pair.rig!r}; expected one of the rigs it states")
    return manifest
