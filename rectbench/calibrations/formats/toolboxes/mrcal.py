"""mrcal's `.cameramodel`: one camera and where it stands, in a text that is a Python dictionary.

| key | what |
|---|---|
| `lensmodel` | `LENSMODEL_` PINHOLE, OPENCV4, OPENCV5, OPENCV8, OPENCV12, CAHVOR or STEREOGRAPHIC |
| `intrinsics` | fx fy cx cy and the model's own numbers |
| `extrinsics`, `rt_cam_ref` | rotation vector and translation, from the reference to the camera |
| `imagersize` | width and height |

Old files call the first key `distortion_model` and its values `DISTORTION_...`. All else, the inputs of
the optimisation above all, is passed over. Pixel (0, 0) is the centre of a pixel. Refused are splined
models, CAHVORE, whose centre moves with the angle, and the panoramas LONLAT and LATLON.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from rectbench.calibrations.assembling import camera_of, inverse, pose_matrix, rigid
from rectbench.calibrations.contract import CameraFormat, Given, PosedCamera
from rectbench.calibrations.documents import Section, Source, errors_at, shown
from rectbench.calibrations.documents.sources import MAX_BYTES, read_bytes
from rectbench.calibrations.layouts import layout_of
from rectbench.cameras import Camera
from rectbench.cameras.brown import COEFFICIENTS
from rectbench.errors import InvalidInput
from rectbench.rigs.file_formats import Writing
from rectbench.rigs.rig import Rig, checked_rotation
from rectbench.types import FloatArray

FOCAL = ("fx", "fy", "cx", "cy")
MODELS = {
    "PINHOLE": ("pinhole", FOCAL),
    "OPENCV4": ("pinhole", (*FOCAL, *COEFFICIENTS[:4])),
    "OPENCV5": ("pinhole", (*FOCAL, *COEFFICIENTS[:5])),
    "OPENCV8": ("pinhole", (*FOCAL, *COEFFICIENTS[:8])),
    "OPENCV12": ("pinhole", (*FOCAL, *COEFFICIENTS)),
    "CAHVOR": ("cahvor", (*FOCAL, "alpha", "beta", "r0", "r1", "r2")),
    "STEREOGRAPHIC": ("stereographic", FOCAL),
}
REFUSED = {
    "SPLINED": "a model without splines, which mrcal-convert-lensmodel fits",
    "CAHVORE": "a lens with one centre, which CAHVORE's is not",
    "LONLAT": "a lens, which a panorama is not",
    "LATLON": "a lens, which a panorama is not",
}
"""What is expected instead of the models that begin so."""

LENS_KEYS = ("lensmodel", "lens_model", "distortion_model")
POSE_KEYS = ("extrinsics", "rt_cam_ref")
EXPECTED = "a Python dictionary of strings, numbers and lists, as mrcal writes it"

LARGEST = 16 << 20
"""Bytes of a file; the inputs of an optimisation with thousands of boards take some MiB."""

MAX_VALUES = 20_000
MAX_DEPTH = 20
"""Lists inside each other; mrcal writes two."""

# Possessive throughout: a way back, which none of these can need, would be kept for each repetition.
SKIPPED = re.compile(r"(?:\s++|#[^\n]*+)*+")
TOKEN = re.compile(
    r"""(?P<mark>[{}\[\](),:])
    |[bBuU]?(?P<string>'(?:[^'\\\n]++|\\.)*+'|"(?:[^"\\\n]++|\\.)*+")
    |(?P<word>[-+.\w]++)""",
    re.VERBOSE,
)
RECOGNISED = re.compile(
    r"""["'](?:lensmodel|lens_model|distortion_model)["']\s*:\s*b?["'](?:LENSMODEL|DISTORTION)_"""
)


def read_posed(source: Source, given: Given) -> PosedCamera:
    """The camera in the file, standing in mrcal's reference frame."""
    file = source.section(parse(_text(source), source.path))
    file.knows("valid_intrinsics_region", "icam_intrinsics*", "optimization_inputs")
    key = next((key for key in LENS_KEYS if key in file), LENS_KEYS[0])
    model, names = _model(file, key)
    params = file.named("intrinsics", names)
    size = file.size("imagersize", given.size)
    camera = camera_of(f"{source.path}: intrinsics", model, size, params)
    return PosedCamera(source.path, camera, _pose(file))


def _model(file: Section, key: str) -> tuple[str, tuple[str, ...]]:
    known = ", ".join(f"LENSMODEL_{name}" for name in MODELS)
    stated = file.text(key, known)
    name = re.sub(r"\A(?:LENSMODEL|DISTORTION)_", "", stated)
    name = "PINHOLE" if stated == "DISTORTION_NONE" else name
    if name in MODELS:
        return MODELS[name]
    instead = next((expected for start, expected in REFUSED.items() if name.startswith(start)), known)
    raise file.fault(key, instead)


def _pose(file: Section) -> FloatArray | None:
    """T_ref_cam [4, 4], or None where the file does not tell."""
    key = next((key for key in POSE_KEYS if key in file), None)
    if key is None:
        return None
    rt = file.numbers(key, "a rotation vector and a translation, six finite numbers", 6)
    with errors_at(file.at(key)):
        R = checked_rotation(Rotation.from_rotvec(rt[:3]).as_matrix(), "its rotation")
    return inverse(rigid(R, rt[3:]))


def _text(source: Source) -> str:
    if len(source.content) <= MAX_BYTES:
        return source.text
    content = read_bytes(source.path, LARGEST + 1)
    if len(content) > LARGEST:
        raise InvalidInput(f"{source.path}: is larger than {LARGEST >> 20} MiB; expected {EXPECTED}")
    return content.decode("latin-1")


def parse(text: str, file: str) -> dict[str, Any]:
    """The dictionary in the text: strings, lists and dictionaries, numbers still being strings.

    Python's own parser would take hours, or all memory, for a text that someone made for that. Raises
    InvalidInput in one line with the line at which the text ends making sense.
    """
    tokens = _tokens(text, file)
    kind, first = next(tokens, ("", ""))
    if (kind, first) != ("mark", "{"):
        raise InvalidInput(f"{file}: begins with {shown(first)}; expected {EXPECTED}")
    content = _dictionary(tokens, file, 1)
    for _, left_over in tokens:
        raise InvalidInput(f"{file}: goes on after its end with {shown(left_over)}; expected {EXPECTED}")
    return content


Tokens = Iterator[tuple[str, str]]
"""Kind (mark, string or word) and text of each."""


def _tokens(text: str, file: str) -> Tokens:
    place = _skipped(text, 0)
    for _ in range(4 * MAX_VALUES):
        if place == len(text):
            return
        found = TOKEN.match(text, place)
        if found is None:
            line = text.count("\n", 0, place) + 1
            raise InvalidInput(
                f"{file}: line {line} has {shown(text[place : place + 20])}; expected {EXPECTED}"
            )
        kind = found.lastgroup or ""
        yield kind, found[kind][1:-1] if kind == "string" else found[kind]
        place = _skipped(text, found.end())
    raise InvalidInput(f"{file}: has over {MAX_VALUES} values; expected {EXPECTED}")


def _skipped(text: str, place: int) -> int:
    """The place after the blanks and comments that begin at `place`."""
    found = SKIPPED.match(text, place)
    return found.end() if found else place


def _dictionary(tokens: Tokens, file: str, depth: int) -> dict[str, Any]:
    content: dict[str, Any] = {}
    for kind, key in tokens:
        if (kind, key) == ("mark", "}"):
            return content
        if kind != "string":
            raise InvalidInput(f"{file}: {shown(key)} stands for a key; expected {EXPECTED}")
        if key in content:
            raise InvalidInput(f"{file}: {shown(key)} is there twice; expected different keys")
        if next(tokens, None) != ("mark", ":"):
            raise InvalidInput(f"{file}: no colon follows the key {shown(key)}; expected {EXPECTED}")
        content[key] = _value(next(tokens, ("", "")), tokens, file, depth)
        if _comma_or(tokens, "}", file):
            return content
    raise InvalidInput(f"{file}: ends amid a dictionary; expected {EXPECTED}")


def _list(tokens: Tokens, end: str, file: str, depth: int) -> list[Any]:
    content: list[Any] = []
    for token in tokens:
        if token == ("mark", end):
            return content
        content.append(_value(token, tokens, file, depth))
        if _comma_or(tokens, end, file):
            return content
    raise InvalidInput(f"{file}: ends amid a list; expected {EXPECTED}")


def _value(token: tuple[str, str], tokens: Tokens, file: str, depth: int) -> Any:
    kind, text = token
    if kind in ("string", "word"):
        return text
    if depth >= MAX_DEPTH:
        raise InvalidInput(f"{file}: is nested too deeply; expected {EXPECTED}")
    if text == "{":
        return _dictionary(tokens, file, depth + 1)
    if text in ("[", "("):
        return _list(tokens, "]" if text == "[" else ")", file, depth + 1)
    raise InvalidInput(f"{file}: {shown(text)} stands for a value; expected {EXPECTED}")


def _comma_or(tokens: Tokens, end: str, file: str) -> bool:
    """Whether the end has come; a comma goes before whatever else follows."""
    _, text = token = next(tokens, ("", ""))
    if token not in (("mark", ","), ("mark", end)):
        found = f"{shown(text)} follows a value" if text else "ends after a value"
        raise InvalidInput(f"{file}: {found}; expected a comma or {end!r}")
    return text == end


def _recognises(source: Source) -> bool:
    if Path(source.path).suffix.lower() == ".cameramodel":
        return True
    return bool(RECOGNISED.search(source.content[: 1 << 16].decode("latin-1")))


def _texts(rig: Rig, name: str) -> dict[str, str]:
    """A file a camera, the left one standing in the reference frame."""
    poses = (("left", rig.left, np.eye(4)), ("right", rig.right, pose_matrix(rig)))
    return {f"{side}.cameramodel": _text_of(camera, T, side) for side, camera, T in poses}


def _text_of(camera: Camera, T_cam_ref: FloatArray, side: str) -> str:
    model, equal = layout_of(camera, MODELS, "mrcal", side)
    rt = [*Rotation.from_matrix(T_cam_ref[:3, :3]).as_rotvec(), *T_cam_ref[:3, 3]]
    entries = {
        "lensmodel": f"LENSMODEL_{model}",
        "intrinsics": [equal.params[name] for name in MODELS[model][1]],
        "extrinsics": [float(number) for number in rt],  # every version knows it; new ones say rt_cam_ref
        "imagersize": list(equal.size),
    }
    lines = "".join(f"    {key!r}: {value!r},\n" for key, value in entries.items())
    return f"{{\n{lines}}}\n"


FORMAT = CameraFormat(
    "mrcal",
    "mrcal .cameramodel (two files)",
    _recognises,
    read_posed,
    write=Writing(_texts, in_folder=True),
)
