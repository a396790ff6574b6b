"""EasyMocap's `intri.yml` and `extri.yml`, two files of `cv::FileStorage` with a list of `names`.

`K_<name>` and `dist_<name>` (or `D_<name>`) are OpenCV's of a pinhole, `H_<name>` and `W_<name>` the image's
size where they are written. `Rot_<name>` (3x3) or `R_<name>` (a rotation vector) and `T_<name>` take points
of the world to the camera, metres. Left and right are the first two names, or those asked for.
"""

from __future__ import annotations

from collections.abc import Sequence

from rectbench.calibrations.assembling import Pair, chosen, inverse, rig_of_posed, rigid
from rectbench.calibrations.checks.consistency import compare_rotations
from rectbench.calibrations.contract import Given, PosedCamera, RigFormat
from rectbench.calibrations.documents import Section, Source
from rectbench.calibrations.formats.toolboxes.opencv import opencv_camera
from rectbench.calibrations.pose_file import read_rotation
from rectbench.errors import InvalidInput
from rectbench.rigs.rig import Rig

FILES = {"K_": "intri.yml", "T_": "extri.yml"}
"""The two files, by how keys begin that only they have."""

LONGEST_NAME = 100
"""Letters of a camera's name; a longer one is damage, which an error need not repeat."""


def _read(sources: Sequence[Source], given: Given) -> Rig:
    first = sources[0]
    files = list(sources)
    if len(files) == 1:
        files += [first.beside(name) for start, name in FILES.items() if not _has(first, start)]
    intrinsics, extrinsics = (_holder(files, start) for start in FILES)
    known = _names(intrinsics)

    def rig_of(names: Pair) -> Rig:
        posed = [_read_posed(intrinsics.document, extrinsics.document, name, given) for name in names]
        return rig_of_posed(posed, given, first.name)

    names = chosen(known, given, intrinsics.path, rig_of)
    for other in set(known) - set(names):
        intrinsics.document.knows(f"K_{other}", f"dist_{other}", f"D_{other}")
        extrinsics.document.knows(f"R_{other}", f"Rot_{other}", f"T_{other}")
    return rig_of(names)


def _holder(sources: Sequence[Source], start: str) -> Source:
    """The one file with keys that begin so."""
    found = [source for source in sources if _has(source, start)]
    if len(found) != 1:
        raise InvalidInput(
            f"{sources[0].path}: comes with {len(found)} files with {start}...; expected one, {FILES[start]}"
        )
    return found[0]


def _names(source: Source) -> list[str]:
    file = source.document.section_of_list("names")
    names = [file.text(place, "a camera's name") for place in file.values]
    for place, name in zip(file.values, names, strict=True):
        if len(name) > LONGEST_NAME:
            raise file.fault(place, f"a camera's name of at most {LONGEST_NAME} letters")
    return names


def _read_posed(intrinsics: Section, extrinsics: Section, name: str, given: Given) -> PosedCamera:
    key = f"dist_{name}" if f"dist_{name}" in intrinsics else f"D_{name}"
    size = intrinsics.sides(f"W_{name}", f"H_{name}", given.size)
    camera = opencv_camera(intrinsics, f"K_{name}", key, "pinhole", size)
    R = read_rotation(extrinsics, f"Rot_{name}" if f"Rot_{name}" in extrinsics else f"R_{name}")
    if f"R_{name}" in extrinsics:
        again = read_rotation(extrinsics, f"R_{name}")
        compare_rotations(extrinsics.at(f"R_{name}"), again, R, f"Rot_{name}")
    t = extrinsics.array(f"T_{name}", "three metres", (3,))
    return PosedCamera(extrinsics.at(f"T_{name}"), camera, inverse(rigid(R, t)))


def _has(source: Source, start: str) -> bool:
    return any(key.startswith(start) for key in source.keys)


def _recognises(source: Source) -> bool:
    return "names" in source.keys and (_has(source, "K_") or _has(source, "T_"))


FORMAT = RigFormat("easymocap", "EasyMocap intri.yml and extri.yml", _recognises, _read, has_many=True)
