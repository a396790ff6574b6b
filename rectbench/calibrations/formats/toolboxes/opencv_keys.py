"""The keys that files of OpenCV calibrations use, and the search for them over several files."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass
from itertools import islice

from rectbench.calibrations.documents import Section
from rectbench.errors import InvalidInput
from rectbench.types import FloatArray

MATRIX = (
    *("M", "K", "cameraMatrix", "camera_matrix", "CameraMatrix", "Camera_Matrix"),
    *("mtx", "intrinsic_matrix", "camera_mat", "camMatrix", "cam_mtx", "cameraMat"),
)
DISTORTION = (
    *("D", "distCoeffs", "dist_coeffs", "distortion_coefficients", "DistCoeffs", "Distortion_Coefficients"),
    *("dist", "distortion", "distortion_coeffs", "dist_coeff", "dist_coefs", "dist_coef", "distCoeff"),
    *("distCoefs", "distCoef", "distortionCoefficients", "distortion_coefficient", "distortionCoeffs"),
)
XI = ("xi",)
ROTATION = ("R", "rvec", "om", "rotation_matrix", "rotation_mat", "rotation", "rotationMatrix", "Rot", "rot")
TRANSLATION = (
    *("T", "tvec", "t", "translation_vector", "translation_vec", "translation", "translationVector"),
    *("Trns", "trans"),
)
MARKS = {*ROTATION[:3], *TRANSLATION[:2]}
"""Keys of a pose that only OpenCV's files have; the long words are in others' too."""

SIX = "extrinsic_parameters"
SIZE = ("imageSize", "image_size", "ImageSize", "cameraResolution")
SIDES = ("image_width", "image_height")
MODEL = ("model", "camera_model")
OTHER_MODEL = (
    *("distortion_model", "distortionModel", "cameraModel", "lens", "lens_model", "lens_type", "lensType"),
    *("camera_type", "cameraType", "projection_model", "distortion_type", "distortion", "type"),
)
"""Keys that may name the lens, and may be about another thing."""

FLAGS = ("fisheye_model", "fisheye", "is_fisheye")

FROM_ONE = (("{}1", "{}2"), ("{}_1", "{}_2"))
FROM_ZERO = (("{}0", "{}1"), ("{}_0", "{}_1"))
PAIRS = (
    ("{}_left", "{}_right"),
    ("left_{}", "right_{}"),
    ("{}Left", "{}Right"),
    ("{}_l", "{}_r"),
    ("{}_L", "{}_R"),
    ("{}L", "{}R"),
    ("{}l", "{}r"),
)
"""How files tell the keys of the left and the right camera apart: by numbers, as OpenCV does, or words."""

SECTIONS = (
    *(("left", "right"), ("left_camera", "right_camera"), ("camera_left", "camera_right")),
    *(("cam_left", "cam_right"), ("cam0", "cam1"), ("camera0", "camera1"), ("camera_0", "camera_1")),
    *(("cam1", "cam2"), ("camera1", "camera2"), ("camera_1", "camera_2")),
)
"""What sections of the two cameras are called."""

SHARED = ("stereo", "extrinsics", "extrinsic", "stereo_calibration", "intrinsics")
"""Sections of a file whose keys count as its own."""


def parts_of(document: Section) -> list[Section]:
    """The file itself and its sections of the two cameras, left first, and of what they share."""
    found = [pair for pair in SECTIONS if all(isinstance(document.values.get(name), dict) for name in pair)]
    names = [*(found[0] if found else ()), *SHARED]
    shared = [document.section(name, "keys") for name in names if isinstance(document.values.get(name), dict)]
    return [document, *shared]


def named(keys: Iterable[str], patterns: Collection[str]) -> tuple[str, ...]:
    """The keys of a camera by these patterns."""
    return tuple(pattern.format(key) for key in keys for pattern in patterns)


@dataclass(frozen=True)
class Files:
    """Files that complete each other; what one lacks is looked for in the next."""

    documents: list[Section]

    def __str__(self) -> str:
        return " + ".join(dict.fromkeys(document.file for document in self.documents))

    def holders(self, keys: tuple[str, ...]) -> Iterator[tuple[Section, str]]:
        return ((document, key) for document in self.documents for key in keys if key in document)

    @property
    def pairs(self) -> tuple[tuple[str, str], ...]:
        """How keys of left and right may be called here."""
        from_zero = tuple(named(MATRIX, (left,)) for left, _ in FROM_ZERO)
        return (FROM_ZERO if any(any(self.holders(keys)) for keys in from_zero) else FROM_ONE) + PAIRS

    def of_camera(self, keys: tuple[str, ...], number: int) -> Iterator[tuple[Section, str]]:
        """Numbered keys anywhere, or else the number-th file that speaks of a camera of its own."""
        yield from self.holders(named(keys, [pair[number - 1] for pair in self.pairs]))
        owners = (document for document in self.documents if any(key in document for key in MATRIX))
        for document in islice(owners, number - 1, number):
            yield from ((document, key) for key in keys if key in document)

    def of_pair(self, document: Section) -> bool:
        """Whether a file speaks of two cameras; in one of a single camera, extrinsics are the board's."""
        return any(key in document for key in named(MATRIX, [right for _, right in self.pairs]))

    def first(self, keys: tuple[str, ...], number: int, expected: str) -> tuple[Section, str]:
        """Document and key where camera `number` has one of `keys`."""
        found = next(self.of_camera(keys, number), None)
        if found is None:
            numbered = " or ".join(f"{key}{number}" for key in keys[:3])
            raise InvalidInput(f"{self}: {numbered} is missing; expected {expected}")
        return found

    def pose(self, keys: tuple[str, ...], expected: str, sizes: tuple[int, ...]) -> tuple[str, FloatArray]:
        """Key and numbers of one half of the pose."""
        for document, key in self.holders(keys):
            return key, document.array(key, expected, sizes)
        raise InvalidInput(
            f"{self}: {' or '.join(keys[:3])} is missing; expected {expected}"
            " (intrinsics and extrinsics in two files are read as a list of both)"
        )
