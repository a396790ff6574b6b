"""The uncertainty of a calibration: the joint covariance of a rig's pose and of its lenses' parameters.

| parameter | what it is |
|---|---|
| `pose.rx`, `pose.ry`, `pose.rz` | rotation vector ω, rad, in the right frame: R = exp([ω]×) R_right_left |
| `pose.tx`, `pose.ty`, `pose.tz` | t_right_left, metres, in the right frame |
| `left.fx`, `right.k1`, `left.poly.0` | a lens's parameter by its model's name; of a sequence, by place |

The rotation is counted about the right camera's frame with t held, so that a covariance of rotation
and translation says by itself which of the two moves with the other.
"""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy.linalg import block_diag
from scipy.spatial.transform import Rotation

from rectbench.cameras import Camera
from rectbench.cameras.sensitivity import parameter_names, with_changes
from rectbench.errors import InvalidInput, UnknownName
from rectbench.rigs.rig import Rig
from rectbench.types import FloatArray
from rectbench.writing import replace_files
from rectbench.yaml_text import yaml_text

ROTATION = ("pose.rx", "pose.ry", "pose.rz")
TRANSLATION = ("pose.tx", "pose.ty", "pose.tz")
POSE = (*ROTATION, *TRANSLATION)
PARTS = ("pose", "left", "right")

WIDEST_DEG = 180.0
ASYMMETRY = 1e-6
"""Largest difference of two correlations that should be equal that still counts as a file's rounding."""
LEAST_EIGENVALUE = -1e-6
"""Of the correlations; a matrix written with six digits may have one a little below 0."""


@dataclass(frozen=True, eq=False)
class RigCovariance:
    """The covariance of a rig's parameters, to first order; what is not named is known exactly.

    Parameters
    ----------
    parameters : names, see this module's table.
    matrix : covariance [P, P] in the parameters' units; it may be singular, as that of a pose is whose
        baseline's length images cannot tell.
    source : where it comes from; prose.

    Raises InvalidInput for names that are none or twice there, and for a matrix that is no covariance.

    >>> import rectbench as rb
    >>> sure = rb.RigCovariance.from_sigmas(rb.load_rig("t265"), focal_px=0.3, parameters={"right.k1": 0.001})
    >>> sure.uncertain
    ('left.fx', 'left.fy', 'right.fx', 'right.fy', 'right.k1')
    >>> sure.sigma("right.k1")
    0.001
    """

    parameters: tuple[str, ...]
    matrix: FloatArray = field(repr=False)
    source: str = ""

    def __post_init__(self) -> None:
        names = tuple(map(str, self.parameters))
        for name in names:
            part, _, parameter = name.partition(".")
            if part not in PARTS or not parameter or (part == "pose" and name not in POSE):
                raise UnknownName("parameter of a rig", name, (*POSE, "left.fx", "right.fx"))
            if names.count(name) > 1:
                raise InvalidInput(f"the parameter {name} is there twice; expected each once")
        object.__setattr__(self, "parameters", names)
        object.__setattr__(self, "matrix", _checked_covariance(self.matrix, names))

    @classmethod
    def from_sigmas(
        cls,
        rig: Rig,
        *,
        rotation_deg: float = 0.0,
        direction_deg: float = 0.0,
        baseline_m: float = 0.0,
        focal_px: float = 0.0,
        centre_px: float = 0.0,
        parameters: Mapping[str, float] | None = None,
        source: str = "stated",
    ) -> RigCovariance:
        """From plain standard deviations, independent of each other.

        Parameters
        ----------
        rotation_deg : size of the right camera's turn, root mean square over all directions of its
            axis, as the size of a `PoseNoise`; a third of its square falls to each axis.
        direction_deg : angle of the baseline in the left camera's frame, likewise.
        baseline_m : the baseline's length.
        focal_px : fx of each camera, fy in proportion: the pixels' shape is known.
        centre_px : cx and cy of each camera.
        parameters : of single parameters by name, beside those.

        Raises InvalidInput for a size that is negative or no number, and for a focal length or centre
        of a lens without that parameter; UnknownName for a parameter that the rig has not.
        """
        sizes = {
            "rotation_deg": rotation_deg,
            "direction_deg": direction_deg,
            "baseline_m": baseline_m,
            "focal_px": focal_px,
            "centre_px": centre_px,
            **(parameters or {}),
        }
        for name, sigma in sizes.items():
            if not isinstance(sigma, int | float | np.number) or not 0 <= sigma < np.inf:
                raise InvalidInput(f"the standard deviation {name} is {sigma!r}; expected a number from 0 on")
            if name.endswith("_deg") and sigma >= WIDEST_DEG:
                raise InvalidInput(f"the standard deviation {name} is {sigma:g}; expected degrees below 180")
        total = cls(POSE, _pose_matrix(rig, np.radians(rotation_deg), np.radians(direction_deg), baseline_m))
        for side, camera in (("left", rig.left), ("right", rig.right)):
            for name, sigma in (("focal_px", focal_px), ("centre_px", centre_px)):
                total += _lens_covariance(side, camera, name, sigma) if sigma else cls((), np.zeros((0, 0)))
        single = {name: sigma for name, sigma in (parameters or {}).items() if sigma}
        total += cls(tuple(single), np.diag(np.square(list(single.values()), dtype=float)))
        total.refuse_unknown(rig)
        return replace(total, source=source)

    @classmethod
    def of_direction(cls, covariance: FloatArray, baseline_m: float, source: str = "") -> RigCovariance:
        """From a covariance [6, 6] of rotation vector (rad, right frame) and direction t / |t|."""
        scale = np.repeat([1.0, baseline_m], 3)
        return cls(POSE, np.asarray(covariance) * np.outer(scale, scale), source)

    def __add__(self, other: RigCovariance) -> RigCovariance:
        """The covariance of the sum of two independent errors."""
        names = tuple(dict.fromkeys((*self.parameters, *other.parameters)))
        sources = " + ".join(dict.fromkeys(filter(None, (self.source, other.source))))
        return RigCovariance(names, self.over(names) + other.over(names), sources)

    def over(self, names: Sequence[str]) -> FloatArray:
        """The covariance [N, N] of these parameters in this order, 0 for one that is not named here."""
        own = [place for place, name in enumerate(self.parameters) if name in names]
        there = [names.index(self.parameters[place]) for place in own]
        matrix = np.zeros((len(names), len(names)))
        matrix[np.ix_(there, there)] = self.matrix[np.ix_(own, own)]
        return matrix

    @property
    def uncertain(self) -> tuple[str, ...]:
        """The parameters that are not known exactly."""
        return tuple(np.array(self.parameters, dtype=object)[np.diag(self.matrix) > 0])

    def sigma(self, name: str) -> float:
        """Standard deviation of one parameter, 0 for one that is not named."""
        variances = dict(zip(self.parameters, np.diag(self.matrix).tolist(), strict=True))
        return math.sqrt(variances.get(name, 0.0))

    def refuse_unknown(self, rig: Rig) -> None:
        """Raise UnknownName for a parameter that the rig's lenses have not."""
        known = {"left": parameter_names(rig.left), "right": parameter_names(rig.right)}
        for name in self.parameters:
            part, _, parameter = name.partition(".")
            if part != "pose" and parameter not in known[part]:
                model = getattr(rig, part).model
                raise UnknownName(f"parameter of the {part} lens ({model})", parameter, known[part])

    def draw(self, rig: Rig, rng: np.random.Generator) -> Rig:
        """A rig about this one, at random as the covariance says; normally distributed."""
        scale = np.sqrt(np.diag(self.matrix))
        variances, axes = np.linalg.eigh(_correlations(self.matrix))
        step = scale * (axes @ (np.sqrt(np.maximum(variances, 0)) * rng.normal(size=len(variances))))
        return moved(rig, dict(zip(self.parameters, step.tolist(), strict=True)))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write it as YAML, which `load_covariance` reads. Raises InvalidInput where that cannot be done.

        >>> import tempfile
        >>> import rectbench as rb
        >>> rig = rb.load_rig("t265")
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     rb.RigCovariance.from_sigmas(rig, rotation_deg=0.1).save(f"{folder}/covariance.yaml")
        ...     rb.load_covariance(f"{folder}/covariance.yaml", rig).sigma("pose.rx").__round__(6)
        0.001008
        """
        content = {"parameters": list(self.parameters), "covariance": self.matrix.tolist()}
        text = yaml_text({"source": self.source, **content} if self.source else content)
        replace_files({Path(path): text}, InvalidInput)


def moved(rig: Rig, change: Mapping[str, float]) -> Rig:
    """The rig with these amounts added to its parameters, by the names and in the units of this module.

    Raises UnknownName for a parameter that the rig has not, InvalidInput where they make no rig.
    """
    by_part: dict[str, dict[str, float]] = {part: {} for part in PARTS}
    for name, amount in change.items():
        part, _, parameter = name.partition(".")
        if part not in PARTS or (part == "pose" and name not in POSE):
            raise UnknownName("parameter of a rig", name, (*POSE, "left.fx", "right.fx"))
        by_part[part][parameter] = amount
    turn, shift = (np.array([change.get(name, 0.0) for name in names]) for names in (ROTATION, TRANSLATION))
    return replace(
        rig,
        left=with_changes(rig.left, by_part["left"]),
        right=with_changes(rig.right, by_part["right"]),
        R_right_left=Rotation.from_rotvec(turn).as_matrix() @ rig.R_right_left,
        t_right_left=rig.t_right_left + shift,
    )


def _pose_matrix(rig: Rig, rotation: float, direction: float, baseline_m: float) -> FloatArray:
    """[6, 6] of a turn about the right centre and of where that centre is, both isotropic, radians.

    The centre stays in the left frame while the camera turns, so t = -R c turns along: dt = ω × t + ε.
    """
    t = rig.t_right_left
    along = np.outer(t, t) / (t @ t)
    carried = -np.array([[0, -t[2], t[1]], [t[2], 0, -t[0]], [-t[1], t[0], 0]])
    both = np.vstack([np.eye(3), carried])
    spread = (direction * rig.baseline_m) ** 2 / 2 * (np.eye(3) - along) + baseline_m**2 * along
    matrix: FloatArray = rotation**2 / 3 * (both @ both.T) + block_diag(np.zeros((3, 3)), spread)
    return matrix


def _lens_covariance(side: str, camera: Camera, name: str, sigma: float) -> RigCovariance:
    """That of a focal length, whose two numbers move as one, or of a principal point, whose do not."""
    wanted = ("fx", "fy") if name == "focal_px" else ("cx", "cy")
    if not set(wanted) <= set(camera.params):
        raise InvalidInput(
            f"{name} is {sigma:g}, but the {side} lens ({camera.model}) has no {' and '.join(wanted)}; "
            "expected single parameters by name"
        )
    names = tuple(f"{side}.{one}" for one in wanted)
    if name == "centre_px":
        return RigCovariance(names, sigma**2 * np.eye(2))
    both = np.array([1.0, camera.params["fy"] / camera.params["fx"]])
    return RigCovariance(names, sigma**2 * np.outer(both, both))


def _checked_covariance(matrix: Any, names: Sequence[str]) -> FloatArray:
    count = len(names)
    try:
        given = np.array(matrix, dtype=np.float64)
    except (TypeError, ValueError):
        raise InvalidInput(f"the covariance is no array of numbers; expected {count}x{count}") from None
    if given.shape != (count, count):
        raise InvalidInput(
            f"the covariance has shape {given.shape}; expected {count}x{count}, as many as names"
        )
    if not np.isfinite(given).all():
        raise InvalidInput("the covariance holds NaN or infinity; expected finite numbers")
    for name, variance in zip(names, np.diag(given), strict=True):
        if variance < 0:
            raise InvalidInput(f"the variance of {name} is {variance:g}; expected a number from 0 on")
    correlations = _correlations(given)
    apart = np.abs(correlations - correlations.T)
    if apart.max(initial=0.0) > ASYMMETRY:
        i, j = divmod(int(apart.argmax()), count)
        raise InvalidInput(
            f"the covariance of {names[i]} and {names[j]} is {given[i, j]:g} and {given[j, i]:g}; "
            "expected a symmetric matrix"
        )
    least = np.linalg.eigvalsh(correlations).min(initial=0.0)
    if least < LEAST_EIGENVALUE * max(1, count):
        raise InvalidInput(
            f"the covariance has an eigenvalue below 0 ({least:.2g} of the correlations); "
            "expected a positive semidefinite matrix"
        )
    symmetric: FloatArray = (given + given.T) / 2
    symmetric.flags.writeable = False
    return symmetric


def _correlations(matrix: FloatArray) -> FloatArray:
    """[P, P], so that parameters of all units are judged alike; of one known exactly, its covariances."""
    scale = np.sqrt(np.diag(matrix))
    scale[scale == 0] = 1.0
    correlations: FloatArray = matrix / np.outer(scale, scale)
    return correlations
