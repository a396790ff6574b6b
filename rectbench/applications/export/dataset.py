"""A rendered dataset as a folder that other tools open: images, truth, rectified pairs, calibrations.

One pair a seed, its files named by the seed and sorted by kind; `README.md.j2` says what each kind
is. A pair is whole when `pairs/NAME.json` is there, written last, with the SHA-256 of each of its files: an
export that was interrupted goes on with the pairs that are not, and one with more seeds adds to those there.
The same settings and seeds give the same bytes.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any

from rectbench.applications.export import pair_files
from rectbench.applications.export.readme import readme_text
from rectbench.applications.one_rig import rig_of
from rectbench.applications.requests.rendering import ExportRequest
from rectbench.errors import InvalidInput
from rectbench.pairs.rendering import RENDERING_PACKAGES, Studio, placed, render_seed
from rectbench.pairs.rig_numbers import rig_numbers
from rectbench.plugins.fitting import checked_options, fit
from rectbench.plugins.rectifier import METHODS, Options, Rectifier, pose_problem
from rectbench.plugins.scene import SCENES, Scene
from rectbench.progress import progress_for
from rectbench.registry import Plugin, registry
from rectbench.rigs import Rig
from rectbench.store.keys import code_digest, digest, file_digest, versions
from rectbench.warps import Rectification
from rectbench.writing import check_writable, write_atomically

DATASET_FILE, README_FILE, PAIRS_FOLDER = "dataset.json", "README.md", "pairs"
VERSION = 1


@dataclass(frozen=True, eq=False)
class _Export:
    """What is exported: a rig in a scene, once a seed, rectified by a method."""

    request: ExportRequest
    rig: Rig
    scene: Plugin[Scene]
    method: Plugin[Rectifier]
    options: Options
    """The method's, those not given at their defaults."""

    @staticmethod
    def of(request: ExportRequest) -> _Export:
        """Raises InvalidInput for a method that works from matches, whose rows are not exact."""
        rig, scene = rig_of(request), registry(SCENES).get(request.scene)
        method = registry(METHODS).get(request.method)
        if "pose" not in method.value.needs:
            raise InvalidInput(
                f"{method.name} works from matches, so its rows do not agree exactly; "
                "expected a method that works from the calibrated pose"
            )
        return _Export(request, rig, scene, method, checked_options(method, request.options))

    def settings(self) -> dict[str, Any]:
        """All that shapes the files of a pair, but for its seed, as JSON."""
        return {
            "scene": self.scene.name,
            "scene_source": self.scene.digest,
            "rig": rig_numbers(self.rig),
            **self.request.model_dump(include={"motion", "image_width", "quality", "spp", "margin_deg"}),
            "method": self.method.name,
            "method_source": self.method.digest,
            "options": self.options.model_dump(mode="json"),
            "code": code_digest(__name__),
            "versions": dict(versions("rectbench", *RENDERING_PACKAGES)),
        }

    def true_rig(self, seed: int) -> Rig:
        """That of a seed's pair."""
        return placed(self.rig, self.scene.name, self.request.motion, seed, self.request.image_width)

    def rectification(self, seed: int) -> Rectification:
        """The rectification of that rig."""
        problem = pose_problem(self.true_rig(seed), seed=seed, margin_deg=self.request.margin_deg)
        return fit(self.method, problem, self.options)


@dataclass(frozen=True)
class Exported:
    """What an export left."""

    folder: Path
    rendered: tuple[int, ...]
    """Seeds whose pairs were made."""
    kept: tuple[int, ...]
    """Seeds whose pairs were there already."""


def export_dataset(request: ExportRequest, progress: bool | None = None) -> Exported:
    """Write the pairs of the seeds into a folder, with `dataset.json` and `README.md`.

    `progress` is a bar on stderr; on a terminal by default. Raises InvalidInput where the folder holds a
    dataset of other settings, and Unsupported where the method cannot serve the rig, before anything is
    rendered; Unavailable where the disk takes no more.
    """
    out, seeds = request.out, list(dict.fromkeys(request.seeds))
    check_writable(out)
    export = _Export.of(request)
    placed(
        export.rig, export.scene.name, request.motion, seeds[0], None
    )  # a wrong motion is no other setting
    settings = export.settings()
    mark, found = digest(settings), _manifests(out)
    _check_same(out, found, mark)
    whole = {seed for seed in seeds if _is_whole(out, found.get(_name(seed)))}
    missing = [seed for seed in seeds if seed not in whole]
    if missing:
        export.rectification(missing[0])  # a method that cannot serve this rig says so before the work begins
    with progress_for(progress).stage("pairs", len(missing)) as advance:
        for seed in missing:
            found[_name(seed)] = _write_pair(export, seed, mark, out)
            advance()
    pairs = [found[name] for name in sorted(found) if _is_whole(out, found[name])]
    content = {"rectbench_dataset": VERSION, "settings": settings, "pairs": pairs}
    write_atomically(out / README_FILE, readme_text(settings, pairs))
    write_atomically(out / DATASET_FILE, _json(content))
    return Exported(out, tuple(missing), tuple(seed for seed in seeds if seed in whole))


def _name(seed: int) -> str:
    return f"{seed:06d}"


def _write_pair(export: _Export, seed: int, mark: str, out: Path) -> dict[str, Any]:
    """Render and write a pair; its manifest, which is written last."""
    rect = export.rectification(seed)
    request, name = export.request, _name(seed)
    stage = Studio().stage(request.scene, seed, request.quality)
    truth, rectified = stage.survey(rect.rig), stage.survey_rectified(rect)
    noise = render_seed(export.scene.name, export.rig.name, request.motion, seed)
    images = stage.photograph(rect.rig, seed=noise, spp=request.spp)
    calibrations, refused = pair_files.calibration_files(rect.rig, name)
    contents = {
        **pair_files.image_files(images, name),
        **pair_files.truth_files(truth, name),
        **pair_files.rectified_files(images, rectified, export.method.name, name),
        **calibrations,
    }
    for path, content in contents.items():
        write_atomically(out / path, content)
    manifest = {
        "name": name,
        "seed": seed,
        "settings": mark,
        **pair_files.pair_facts(truth, rectified),
        "calibrations_not_written": refused,
        "files": {path: sha256(content).hexdigest() for path, content in sorted(contents.items())},
    }
    write_atomically(out / PAIRS_FOLDER / f"{name}.json", _json(manifest))
    return manifest


def _json(content: Any) -> str:
    return json.dumps(content, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def _manifests(out: Path) -> dict[str, dict[str, Any]]:
    """What is told of the pairs in a folder; one that cannot be read counts as not there."""
    found: dict[str, dict[str, Any]] = {}
    for path in sorted((out / PAIRS_FOLDER).glob("*.json")):
        try:
            content = json.loads(path.read_text(encoding="utf-8"))
        except (OSError, ValueError):
            continue
        if isinstance(content, dict) and content.get("name") == path.stem:
            found[path.stem] = content
    return found


def _check_same(out: Path, found: Mapping[str, Mapping[str, Any]], mark: str) -> None:
    for name, manifest in found.items():
        if manifest.get("settings") != mark:
            raise InvalidInput(
                f"{out} holds pair {name} of other settings, scene, rig or version; expected another folder, "
                f"or the settings in its {DATASET_FILE}"
            )


def _is_whole(out: Path, manifest: Mapping[str, Any] | None) -> bool:
    files = (manifest or {}).get("files")
    return isinstance(files, dict) and all(
        (out / path).is_file() and file_digest(out / path) == told for path, told in files.items()
    )
