"""`rectbench-data.yaml`: what names and calibration files of a folder of photographs do not tell.

rigs:
  front: {files: [front/chain.yaml], unit: mm, max_angle_deg: 80, cameras: [cam2, cam3]}
pairs:
  - {name: hall, left: a/17.png, right: b/23.png, rig: front}

Both are optional, and so is every key but `files`, `left` and `right`. What is not stated is found as ever.
"""

from __future__ import annotations

from pathlib import Path

import yaml
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from rectbench.errors import InvalidInput

MANIFEST = "rectbench-data.yaml"
MOST_BYTES = 1 << 20


class StatedRig(BaseModel):
    """A calibration by its files, as `load_rig` takes them."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    files: tuple[str, ...] = Field(min_length=1)
    unit: str | None = None
    max_angle_deg: float | None = Field(default=None, gt=0, le=180)
    cameras: tuple[str, str] | None = None


class StatedPair(BaseModel):
    """Two images that belong together."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    left: str
    right: str
    name: str | None = Field(default=None, min_length=1)
    rig: str | None = None


class Manifest(BaseModel):
    """The whole file; paths are relative to its folder."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    rigs: dict[str, StatedRig] = Field(default_factory=dict)
    pairs: tuple[StatedPair, ...] = ()


def read_manifest(folder: Path) -> Manifest:
    """The manifest of a folder, an empty one where it has none.

    Raises InvalidInput in one line that names the file and the key for one that cannot be used.
    """
    path = folder / MANIFEST
    if not path.is_file():
        return Manifest()
    try:
        if path.stat().st_size > MOST_BYTES:
            raise InvalidInput(f"{path}: is over {MOST_BYTES >> 20} MiB; expected a list of rigs and pairs")
        document = yaml.safe_load(path.read_text(encoding="utf-8"))
    except InvalidInput:
        raise
    except (OSError, ValueError, yaml.YAMLError, RecursionError) as error:
        raise InvalidInput(f"{path}: cannot be read: {' '.join(str(error).split())}") from None
    try:
        manifest = Manifest.model_validate(document or {})
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(map(str, first["loc"])) or "the file"
        raise InvalidInput(f"{path}: {where}: {first['msg']}") from None
    _check_files(path, manifest)
    return manifest


def _check_files(path: Path, manifest: Manifest) -> None:
    named = [(f"rigs.{name}.files", file) for name, rig in manifest.rigs.items() for file in rig.files]
    for i, pair in enumerate(manifest.pairs):
        named += [(f"pairs.{i}.left", pair.left), (f"pairs.{i}.right", pair.right)]
        if pair.rig is not None and pair.rig not in manifest.rigs:
            raise InvalidInput(f"{path}: pairs.{i}.rig is {pair.rig!r}; expected one of the rigs it states")
    for key, file in named:
        if not (path.parent / file).is_file():
            raise InvalidInput(f"{path}: {key}: {file}: no such file")
