"""The pose of the right camera relative to the left one, from matches or images, for lenses of any width.

Zhou, Dai and Li, Algorithm 1, steps 1 and 2: features, five points, robust consensus, bundle adjustment;
on rays throughout, so that a lens may see 180 degrees and more.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from time import perf_counter
from types import MappingProxyType
from typing import Literal

import numpy as np
from scipy.linalg import block_diag
from scipy.spatial.transform import Rotation
from scipy.special import ndtr, stdtrit

from rectbench.cameras import Camera
from rectbench.errors import InvalidInput, PoseNotFound, UnknownName
from rectbench.matching.features.matches import RATIO, match_features
from rectbench.matching.pose.bundle import PARAMETERS, adjusted
from rectbench.matching.pose.epipolar import (
    Pose,
    RayMatches,
    decomposed,
    essential,
    in_front,
    sampson_px,
    tangents,
)
from rectbench.matching.pose.evidence import (
    depth_consistent,
    refuse_behind,
    refuse_chance,
    refuse_pure_rotation,
    refuse_same_place,
)
from rectbench.matching.pose.inlier_set import agreed_by_most
from rectbench.matching.pose.robust import consensus, deviation, locally_optimised
from rectbench.rigs import Rig
from rectbench.rigs.covariance import RigCovariance
from rectbench.types import FloatArray, Images, Matches

LEAST_MATCHES = 8
THRESHOLD_PX = 3.0
"""Sampson distance of a wrong match, at the resolution where features are found."""
POSE_PIXELS = 600_000
"""On four times as many, features take three times as long, and the poses are hardly better."""
MOST_FEATURES = 4000
POSE_PER_CELL = 10
"""Matches kept in one of some 170 cells: corners of the view count as much as its busiest part."""
WITHIN_DEVIATIONS = 4.0
"""A match farther off than this many times the noise is an outlier."""
MEDIANS_WORTH = 0.37
"""What a normal distance adds to the noise's degrees of freedom, where their median tells it."""
FINEST_PX = 1e-3
"""What exact matches are taken to be exact to."""
CONTRADICTING_DEG = 30.0
"""No calibration is off by so much."""
FORWARD_DEG = 45.0
"""A baseline nearer to the optical axes than this is a forward motion."""
USUAL_SEARCH = "ransac"
SEARCHES: Mapping[str, Callable[[RayMatches, float, int], Pose]] = {
    USUAL_SEARCH: consensus,
    "inlier-set": agreed_by_most,
}
"""Ways to the pose that matches agree on, by name: five-point samples, or branch and bound over all poses."""


@dataclass(frozen=True, eq=False)
class PoseEstimate:
    """The pose of the right camera relative to the left one as the images show it: X_right = R X_left + t.

    The length of t cannot be seen; `rig` takes it from the calibration.

    >>> import cv2, numpy as np
    >>> import rectbench as rb
    >>> noise = np.random.default_rng(0).integers(0, 256, (120, 160), np.uint8)
    >>> left = cv2.normalize(cv2.GaussianBlur(noise, (0, 0), 2), None, 0, 255, cv2.NORM_MINMAX)
    >>> right = np.concatenate([np.roll(left[:60], -6, axis=1), np.roll(left[60:], -12, axis=1)])
    >>> camera = rb.Camera("pinhole", (160, 120), {"fx": 120, "fy": 120, "cx": 79.5, "cy": 59.5})
    >>> rig = rb.Rig(camera, camera, np.eye(3), [-0.1, 0, 0])
    >>> estimate = rb.estimate_pose((left, right), rig)
    >>> estimate.motion, max(estimate.difference_deg(rig)) < 0.1
    ('sideways', True)
    """

    R_right_left: FloatArray
    """[3, 3]"""
    direction_right_left: FloatArray
    """t / |t| [3]."""
    covariance: FloatArray
    """[6, 6], rank 5: of the rotation vector in the right frame (rad), then of the direction."""
    inliers: Matches
    """The matches that the pose explains, seen ahead of both cameras."""
    given: int
    """How many matches there were."""
    noise_px: float
    """Standard deviation of a coordinate of the inliers' pixels."""
    motion: Literal["sideways", "forward"]
    """forward where the baseline is within 45 degrees of the optical axes."""
    seconds: Mapping[str, float] = field(repr=False)
    """Wall time by stage: features, consensus, adjustment."""
    note: str = ""
    """What contradicts this pose in a calibration, see `contradiction`."""

    @property
    def rotation_vector_deg(self) -> FloatArray:
        """The rotation from left to right coordinates: its axis, as long as its angle in degrees [3]."""
        return Rotation.from_matrix(self.R_right_left).as_rotvec(degrees=True)

    @property
    def rotation_sigma_deg(self) -> float:
        """Standard deviation of the rotation, degrees: the root of the sum over the three axes."""
        return float(np.degrees(np.sqrt(np.trace(self.covariance[:3, :3]))))

    @property
    def direction_sigma_deg(self) -> float:
        """Standard deviation of the direction of the baseline, degrees, over its two degrees of freedom."""
        return float(np.degrees(np.sqrt(np.trace(self.covariance[3:, 3:]))))

    def difference_deg(self, rig: Rig) -> tuple[float, float]:
        """Angles between this pose and a rig's: of the rotations, and of the directions."""
        turn = Rotation.from_matrix(self.R_right_left @ rig.R_right_left.T)
        cosine = self.direction_right_left @ rig.t_right_left / rig.baseline_m
        sine = np.linalg.norm(np.cross(self.direction_right_left, rig.t_right_left)) / rig.baseline_m
        return float(np.degrees(turn.magnitude())), float(np.degrees(np.arctan2(sine, cosine)))

    def contradiction(self, rig: Rig) -> str:
        """What contradicts the images being this rig's, in one line; empty where they agree."""
        rotation_deg, direction_deg = self.difference_deg(rig)
        swapped_deg, _ = self.difference_deg(_swapped(rig))
        if direction_deg > 180 - CONTRADICTING_DEG and swapped_deg < CONTRADICTING_DEG:
            return "the images look swapped: the right one was taken from the left of the other"
        if max(rotation_deg, direction_deg - 3 * self.direction_sigma_deg) > CONTRADICTING_DEG:
            return (
                f"the pose is off the calibration of {rig.name} by {rotation_deg:.0f} degrees of rotation "
                f"and {direction_deg:.0f} of direction"
            )
        return ""

    def rig_covariance(self, rig: Rig) -> RigCovariance:
        """How sure the pose of `self.rig(rig)` is; its lenses and its baseline's length count as exact.

        Real lenses are not: add the uncertainty of their calibration, see `RigCovariance.from_sigmas`.
        """
        source = "pose estimated from the images, lenses and baseline's length taken as exact"
        return RigCovariance.of_direction(self.covariance, rig.baseline_m, source)

    def rig(self, rig: Rig) -> Rig:
        """The rig with its own cameras and baseline length, and this pose."""
        t = self.direction_right_left * rig.baseline_m
        return replace(rig, R_right_left=self.R_right_left, t_right_left=t)


def _swapped(rig: Rig) -> Rig:
    """The rig as it is where left and right are confused."""
    R = rig.R_right_left.T
    return Rig(rig.right, rig.left, R, -R @ rig.t_right_left)


def pose_from_images(
    left: Camera,
    right: Camera,
    images: Images,
    *,
    detector: str = "sift",
    ratio: float = RATIO,
    farthest: float | None = None,
    working_pixels: float | None = POSE_PIXELS,
    search: str = USUAL_SEARCH,
    seed: int = 0,
) -> PoseEstimate:
    """The pose from two photographs, see `match_features` and `relative_pose`.

    Features are found on images of `working_pixels`; None takes the images as they are. Raises
    InvalidInput where an image has not its camera's size; PoseNotFound, with the reason, where the
    images do not determine the pose.
    """
    for side, camera, image in zip(("left", "right"), (left, right), images, strict=True):
        if image.shape[1::-1] != camera.size:
            raise InvalidInput(
                f"the {side} image is {'x'.join(map(str, image.shape[1::-1]))} px; expected "
                f"{camera.width}x{camera.height}, the size of its camera"
            )
    if np.array_equal(images.left, images.right):
        raise PoseNotFound("the two images are identical; expected photographs from two places")
    start = perf_counter()
    matches = match_features(
        *images,
        detector=detector,
        ratio=ratio,
        farthest=farthest,
        working_pixels=working_pixels,
        most=MOST_FEATURES,
        per_cell=POSE_PER_CELL,
    )
    features_s = perf_counter() - start
    area = max(left.width * left.height, right.width * right.height)
    reduction = 1.0 if working_pixels is None else max(1.0, np.sqrt(area / working_pixels))
    refuse_same_place(matches, reduction)
    threshold_px = THRESHOLD_PX * reduction
    found = relative_pose(left, right, matches, threshold_px=threshold_px, search=search, seed=seed)
    return replace(found, seconds=MappingProxyType({"features": features_s, **found.seconds}))


def relative_pose(
    left: Camera,
    right: Camera,
    matches: Matches,
    *,
    threshold_px: float = THRESHOLD_PX,
    search: str = USUAL_SEARCH,
    seed: int = 0,
) -> PoseEstimate:
    """The pose from matched pixels [N, 2] each, gross outliers among them.

    RANSAC over five-point samples, or another search of `SEARCHES`, bundle adjustment over the consensus, and
    the tests that tell a pose from an accident. `threshold_px` is a Sampson distance in source pixels beyond
    which a match is wrong; below, the noise is measured. The order of the matches means nothing. Raises
    InvalidInput for arrays that are no matches; UnknownName for a search that there is not; PoseNotFound
    with the reason.
    """
    if search not in SEARCHES:
        raise UnknownName("search", str(search), SEARCHES)
    shapes = [np.shape(pixels) for pixels in matches]
    if shapes[0] != shapes[1] or len(shapes[0]) != 2 or shapes[0][1] != 2:
        raise InvalidInput(f"matches of shapes {shapes[0]} and {shapes[1]}; expected the same [N, 2] twice")
    start, given = perf_counter(), len(matches.left)
    seen, _ = RayMatches.of(left, right, matches)
    _refuse_few(len(seen), given)
    pose, limit_px = _narrowed(SEARCHES[search](seen, threshold_px, seed), seen, threshold_px)
    refuse_chance(pose, seen, limit_px, seed)
    fitting = seen[np.abs(sampson_px(seen.terms(), essential(pose))[0]) <= limit_px]
    pose = max(decomposed(essential(pose)), key=lambda one: int(in_front(one, fitting, limit_px).sum()))
    ahead = fitting[in_front(pose, fitting, limit_px)]
    if len(ahead) < LEAST_MATCHES:
        refuse_behind(pose, fitting, limit_px)
        _refuse_few(len(ahead), given)
    consensus_s = perf_counter() - start

    start = perf_counter()
    result = adjusted(left, right, pose, ahead)
    # Too few are within what the consensus left of its own matches' noise.
    limit_px = min(threshold_px, _outlying_px(result.noise_px, len(ahead)))
    fitting = seen[np.abs(sampson_px(seen.terms(), essential(result.pose))[0]) <= limit_px]
    ahead = fitting[in_front(result.pose, fitting, limit_px)]
    ahead = ahead[depth_consistent(result.pose, ahead, limit_px)]
    result = adjusted(left, right, result.pose, ahead)
    limit_px = min(threshold_px, _outlying_px(result.noise_px, len(ahead)))
    inliers = ahead[(result.distances_px <= limit_px) & in_front(result.pose, ahead, limit_px)]
    _refuse_few(len(inliers), given)
    limit_px = WITHIN_DEVIATIONS * max(result.noise_px, FINEST_PX)
    refuse_pure_rotation(result.pose, fitting, limit_px)
    refuse_behind(result.pose, fitting, limit_px)
    across = block_diag(np.eye(3), tangents(result.pose.t))
    return PoseEstimate(
        R_right_left=result.pose.R,
        direction_right_left=result.pose.t,
        covariance=across @ result.covariance @ across.T,
        inliers=inliers.pixels,
        given=given,
        noise_px=result.noise_px,
        motion=_motion(result.pose),
        seconds=MappingProxyType({"consensus": consensus_s, "adjustment": perf_counter() - start}),
    )


def _narrowed(pose: Pose, matches: RayMatches, limit_px: float) -> tuple[Pose, float]:
    """The consensus with the limit that its own noise asks for, never a wider one."""
    terms = matches.terms()
    for _ in range(2):
        distances = sampson_px(terms, essential(pose))[0]
        noise_px = deviation(distances, limit_px)
        limit_px = min(limit_px, _outlying_px(noise_px, int((np.abs(distances) < limit_px).sum())))
        pose = locally_optimised(pose, terms, limit_px)
    return pose, limit_px


def _outlying_px(noise_px: float, count: int) -> float:
    """Beyond it a match is an outlier, of `count` whose distances' median tells the noise.

    Four deviations of many matches. Few tell the noise badly: where it comes out small, four would cut right
    matches off, and what is left would look too exact. So it is Student's t that tells what is as rare.
    """
    freedom = MEDIANS_WORTH * max(count - PARAMETERS, 1)
    rarity = float(ndtr(-WITHIN_DEVIATIONS))
    return float(-stdtrit(freedom, rarity)) * max(noise_px, FINEST_PX)


def _refuse_few(count: int, given: int) -> None:
    if count < LEAST_MATCHES:
        found = f"{count} matches" if count == given else f"{count} of {given} matches fit together"
        raise PoseNotFound(f"{found}; expected at least {LEAST_MATCHES}")


def _motion(pose: Pose) -> Literal["sideways", "forward"]:
    """By the angle between the baseline and the two optical axes, their mean."""
    cosines = abs(pose.t[2]), abs((pose.R.T @ pose.t)[2])
    return "forward" if np.mean(cosines) > np.cos(np.radians(FORWARD_DEG)) else "sideways"
