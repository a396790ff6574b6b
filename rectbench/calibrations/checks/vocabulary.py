"""How keys of lenses and poses are called, in calibration files of any format."""

from __future__ import annotations

import re
from functools import lru_cache

DISTORTION = frozenset(
    (
        *("distortion", "distortions", "distort", "disto", "dist", "coeff", "coeffs", "coefs"),
        *("coefficients", "radial", "tangential", "poly", "polynomial", "prism", "fisheye"),
    )
)
LENS = DISTORTION | frozenset(
    (
        *("intrinsic", "intrinsics", "model", "lens", "focal", "skew", "principal", "projection", "mirror"),
        *("affine", "stretch", "fx", "fy", "cx", "cy", "xi", "tau", "omega", "mtx", "equidistant"),
        *("fov", "hfov", "vfov", "dfov", "angle", "aspect", "ratio", "aperture", "cde", "ppx", "ppy"),
    )
)
POSE = frozenset(
    (
        *("rotation", "rot", "translation", "trans", "rvec", "tvec", "rodrigues", "quaternion", "extrinsic"),
        *("extrinsics", "pose", "baseline", "rectification", "rectify", "transform", "transformation"),
        *("correction", "roll", "pitch", "yaw", "rpy", "euler", "quat"),
    )
)
LEAST_LETTERS = 6
LETTERS = frozenset("KDRTPM")
"""Capitals that, as a word of a key, are a matrix of the lens or of the pose."""

SHORT = re.compile(r"[kdrtpmf]|k[1-6]|[pt][12]|s[1-4]")
"""A whole key, but for its camera's number or side, that is a coefficient or a matrix."""

COEFFICIENT = re.compile(r"k[1-6]|[pt][12]|s[1-4]|[dD]")
"""The same of a distortion alone."""

NAMED_COEFFICIENT = re.compile(r"k[1-6]|p[12]")
"""Part of a key that is a coefficient's name, whatever else stands beside it."""

SEPARATOR = re.compile(r"[_\W]+")
"""Between the parts of a key."""

TYPES = frozenset(("type", "kind"))
"""Words whose value tells: a number, or a word on a lens."""

FLAGS = frozenset(("true", "false"))
"""Values that say something under a lens's own words alone: `fisheye`, and not `calib_intrinsics`."""

LENS_WORDS = re.compile(
    r"pinhole|fish.?eye|equi|kannala|radtan|radial|tangential|plumb|brown|conrady|rational|omni|mei\b|unified"
    r"|perspective|ucm|double.?sphere|scaramuzza|ocam|division|theta|poly|opencv",
    re.IGNORECASE,
)
"""Of values: what names a projection model."""

OTHERS = frozenset(
    (
        *("imu", "gyro", "gyroscope", "accel", "accelerometer", "magnetometer", "lidar", "laser", "gps"),
        *("gnss", "wheel", "vehicle", "essential", "fundamental", "error", "errors", "err", "rms", "rmse"),
        *("std", "stddev", "sigma", "deviation", "deviations", "covariance", "cov", "time", "timestamp"),
        *("date", "roi", "points", "point", "corner", "corners", "board", "pattern", "target", "square"),
        *("color", "colour", "noise", "bias", "vignette", "response", "topic", "rostopic", "per", "view"),
        *("views", "fps", "rate", "flags", "criteria", "path", "file", "name", "label", "id", "version"),
        *("overlaps", "overlapping", "count", "threshold", "thr", "distance", "mask", "mocap", "marker"),
        *("tracking", "loop", "keyframe", "viewer", "feature", "features", "optimizer", "optimization"),
        *("estimate", "estimated"),
    )
)
"""Words of keys that are about other things than the two lenses and how they stand."""

LONG = frozenset(word for word in LENS | POSE if len(word) >= LEAST_LETTERS)
"""Words that are found within another, as in `radialdistortion`."""

SIDES = frozenset(("left", "right", "l", "r", "cam", "camera", "c"))

WORD = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+")
"""A word of a key in snake_case, camelCase or CAPITALS."""


@lru_cache(maxsize=4096)
def words_of(key: str) -> frozenset[str]:
    """The words of a key, in small letters."""
    words = {word.lower() for word in WORD.findall(key)}
    return frozenset(words.union(*({long for long in LONG if long in word} for word in words)))


def bare(key: str) -> str:
    """A key without its camera's side or number."""
    last = key.rpartition(".")[2]
    words = [word for word in SEPARATOR.split(last) if word.lower() not in SIDES]
    return words[0] if len(words) == 1 else last
