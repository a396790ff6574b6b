"""The verbs of `import rectbench as rb`: estimate a pose, rectify a rig, render or export, run a report."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rectbench.calibrations import holds_many, load_rig, load_rig_of_images
from rectbench.calibrations.reading import RigSource
from rectbench.errors import InvalidInput
from rectbench.matching.features.matches import RATIO
from rectbench.matching.pose.estimate import POSE_PIXELS, PoseEstimate, pose_from_images
from rectbench.pairs.rendering import placed, render_seed
from rectbench.plugins.defaults import DEFAULT_METHOD, UNCALIBRATED_METHOD
from rectbench.plugins.fitting import checked_options, fit
from rectbench.plugins.rectifier import METHODS, pose_problem
from rectbench.plugins.scene import SCENES
from rectbench.registry import is_path, registry
from rectbench.rigs import Rig
from rectbench.types import FloatArray, Images, Matches
from rectbench.warps import Framing, Rectification

if TYPE_CHECKING:
    import pandas as pd

    from rectbench.applications.export.exporting import Exported
    from rectbench.applications.rectified_images import RectifiedImages
    from rectbench.experiments.spec import Report
    from rectbench.images.stereo_pair import StereoPair
    from rectbench.pairs.finding.names import FilePair
    from rectbench.rendering.truth import Truth

SIDES = ("left", "right")


def rectify(
    rig: Rig,
    method: str | Path = DEFAULT_METHOD,
    images: StereoPair | Sequence[ArrayLike] | None = None,
    pixels: ArrayLike | None = None,
    matches: Sequence[ArrayLike] | None = None,
    seed: int = 0,
    **options: Any,
) -> Rectification:
    """Rectify a rig.

    Parameters
    ----------
    rig : the calibrated rig, see `load_rig`.
    method : a method's name (`rectbench list methods`), or the path of a file that holds one.
    images : the two photographs [H, W] or [H, W, 3], of their cameras' sizes; for methods that look
        at them.
    pixels : [N, 2] source pixels, the same in both images, whose distortion a method minimises; by
        default the evaluation grid of about 500 that the metric uses.
    matches : corresponding pixels (left [N, 2], right [N, 2]), for methods that work from them; by
        default they are made from the rig's pose.
    seed : of a method's random choices.
    options : the method's own (`rectbench list methods --verbose`).

    Returns the rectification, see `Rectification`. Raises UnknownName for a method or option that
    does not exist; InvalidInput for an argument that cannot be used; Unsupported, with the reason,
    where the method cannot serve this rig; InvalidResult where a plugin's answer is no rectification.
    """
    if not isinstance(rig, Rig):
        raise InvalidInput(f"rig is {type(rig).__name__}; expected a Rig, see rectbench.load_rig")
    plugin = registry(METHODS).get(method)
    problem = pose_problem(
        rig,
        pixels=None if pixels is None else _checked_pixels(pixels, "pixels"),
        matches=None if matches is None else _checked_matches(matches),
        images=None if images is None else _checked_images(images, rig),
        seed=_checked_seed(seed),
    )
    return fit(plugin, problem, checked_options(plugin, options))


def rectify_images(
    left: str | Path,
    right: str | Path,
    rig: Rig | RigSource | Sequence[RigSource] | None = None,
    out: str | Path = "rectified",
    *,
    method: str | Path | None = None,
    options: Mapping[str, Any] | None = None,
    framing: Framing | None = None,
    antialias: bool = False,
    tables: Sequence[str] = ("npz", "opencv", "fixed"),
    measured_pairs: int = 5,
    seed: int = 0,
    max_angle_deg: float | None = None,
    unit: str | None = None,
    cameras: Sequence[str] | None = None,
    progress: bool | None = None,
) -> RectifiedImages:
    """Rectify photographs into a folder: images, masks, lookup tables, descriptions, metrics.

    Parameters
    ----------
    left, right : two image files, two folders, or two patterns such as "left/*.png", paired by name.
    rig : a rig, its calibration's files or a rig's name, see `load_rig`. Without one, the methods that
        work from matches alone run, on pinholes of a view that is assumed.
    out : the folder.
    method : a method's name or file, or `best`: all that apply are measured, see `best_method`. By
        default `local-homography`; without a rig `hartley`.
    options : the method's own.
    framing : what is shown and how large; the method's own frame by default.
    antialias : whether to average over the footprint of a pixel where the image shrinks.
    tables : kinds of lookup tables: npz, opencv (FileStorage), fixed (CV_16SC2).
    measured_pairs : so many pairs, spread over all, have their rows measured by their own features and, if
        they show one, a calibration board.
    seed : of random choices.
    max_angle_deg, unit, cameras : the lenses' image circle, what translations are in, and which two
        cameras are meant, where the calibration does not tell.
    progress : a bar on stderr; where there are several pairs and a terminal by default.

    Returns what was made; see `rectbench.applications.rectified_images` for the files, and for what
    is raised.
    """
    from rectbench.applications.rectified_images import Wanted, first_readable, rectify_images
    from rectbench.matching.pose.uncalibrated import uncalibrated
    from rectbench.pairs.finding.image_pairs import image_pairs
    from rectbench.progress import progress_for
    from rectbench.runs.record import check_writable

    check_writable(Path(out))
    wanted = Wanted(
        method=str(method or (UNCALIBRATED_METHOD if rig is None else DEFAULT_METHOD)),
        options=options or {},
        framing=framing or Framing(),
        tables=tuple(tables),
        filter="area" if antialias else "point",
        measured_pairs=measured_pairs,
        seed=_checked_seed(seed),
        without_calibration=rig is None,
    )
    pairing = image_pairs(str(left), str(right))
    _, images = first_readable(pairing.pairs)
    if rig is None:
        calibrated, matches = uncalibrated(images, seed=seed)
    else:
        size, matches = (images.left.shape[1], images.left.shape[0]), None
        if cameras is None:
            _refuse_guessed_cameras(rig, pairing.pairs[0])
        calibrated = rig if isinstance(rig, Rig) else load_rig_of_images(rig, size, unit, cameras)
    if max_angle_deg is not None:
        calibrated = calibrated.within(max_angle_deg)
    bars = progress_for(False if len(pairing.pairs) == 1 else progress)
    return rectify_images(pairing, calibrated, wanted, Path(out), matches=matches, progress=bars)


def _refuse_guessed_cameras(rig: Rig | RigSource | Sequence[RigSource], pair: FilePair) -> None:
    """Raise InvalidInput for images numbered as others than the first two cameras of a file of many."""
    from rectbench.pairs.finding.names import camera_numbers

    numbers = camera_numbers(pair)
    files = [] if isinstance(rig, Rig) else [rig] if isinstance(rig, str | os.PathLike) else list(rig)
    if numbers is not None and any(map(holds_many, files)):
        raise InvalidInput(
            f"{pair.left} is of camera {numbers[0]}, and {files[0]} may hold many; expected the names of two "
            "(cameras, --cameras)"
        )


def estimate_pose(
    images: StereoPair | Sequence[ArrayLike],
    rig: Rig,
    *,
    detector: str = "sift",
    ratio: float = RATIO,
    farthest: float | None = None,
    working_pixels: float | None = POSE_PIXELS,
    seed: int = 0,
) -> PoseEstimate:
    """How the right camera stands to the left one as two photographs show it.

    Parameters
    ----------
    images : the two photographs [H, W] or [H, W, channels], of 8 or 16 bits or float, of their
        cameras' sizes.
    rig : the calibrated rig. Its cameras are used; its pose is only compared with the estimate.
    detector : of features: sift, akaze, orb, or surf where OpenCV has it.
    ratio, farthest : a match must be nearer than the second best by this factor, and its descriptor
        no farther than this; see `match_features`.
    working_pixels : a larger image is made as small before features are sought; None leaves it.
    seed : of the random samples; the same seed gives the same pose to the last bit.

    Returns the pose, with its covariance and the matches it explains; its `note` says where it
    contradicts the rig's own pose, as that of swapped images does. `estimate.rig(rig)` is the rig
    in that pose. Raises PoseNotFound, with the reason, where the images tell no pose: too few
    matches, none that agree, or a turn alone; InvalidInput for images that are not this rig's.
    """
    if not isinstance(rig, Rig):
        raise InvalidInput(f"rig is {type(rig).__name__}; expected a Rig, see rectbench.load_rig")
    pair = _checked_images(images, rig)
    found = pose_from_images(
        rig.left,
        rig.right,
        pair,
        detector=detector,
        ratio=_checked_positive(ratio, "ratio"),
        farthest=None if farthest is None else _checked_positive(farthest, "farthest"),
        working_pixels=None
        if working_pixels is None
        else _checked_positive(working_pixels, "working_pixels"),
        seed=_checked_seed(seed),
    )
    return replace(found, note=found.contradiction(rig))


def render(
    scene: str | Path,
    rig: Rig | str | Path,
    motion: str = "as-calibrated",
    seed: int = 0,
    spp: int = 64,
    quality: str = "path",
    image_width: int | None = None,
) -> tuple[StereoPair, Truth]:
    """Render a rig in a scene: the same pair as a report's for the same names and seed.

    Parameters
    ----------
    scene : a scene's name, or the path of a file that holds one or of a Mitsuba `.xml`.
    rig : a rig, or the name or path of one.
    motion : how the right camera stands to the left, see `rectbench list motions`.
    seed : of the scene, the motion's irregularities and the noise.
    spp : samples a pixel, a power of two.
    quality : `path` traces light paths, `fast` shades at a tenth of the cost.
    image_width : width to which the rig is scaled, pixels; its own by default.

    Returns the images and the truth about them. Raises UnknownName, InvalidInput, or Unavailable
    where this machine cannot render.
    """
    from rectbench.rendering.pair import render_pair

    found = registry(SCENES).get(scene)
    calibrated = rig if isinstance(rig, Rig) else load_rig(rig)
    true_rig = placed(calibrated, found.name, motion, _checked_seed(seed), _checked_width(image_width))
    noise = render_seed(found.name, calibrated.name, motion, seed)
    return render_pair(found.value.build(seed), true_rig, seed=noise, spp=spp, quality=quality)


def export_dataset(
    scene: str | Path,
    rig: Rig | str | Path,
    out: str | Path,
    *,
    motion: str = "as-calibrated",
    seeds: Sequence[int] = (0,),
    spp: int = 64,
    quality: str = "path",
    image_width: int | None = None,
    method: str | Path = DEFAULT_METHOD,
    options: Mapping[str, Any] | None = None,
    progress: bool | None = None,
) -> Exported:
    """Render a dataset that other tools open: a pair a seed, the truth about it, and its rectification.

    Parameters
    ----------
    scene, rig, motion, spp, quality, image_width : as in `render`, which gives the same images for a seed.
    out : the dataset's folder; what of the same dataset is whole there already is kept.
    seeds : a pair each.
    method, options : what rectifies the pairs, from their true rig; a method that works from the pose.
    progress : a bar on stderr; on a terminal by default.

    Written are images, depth, visibility and flow; the rectified pair with its masks and exact disparity;
    calibrations; `README.md`, which says what each file holds and how it is read, and `dataset.json`. See
    `rectbench.applications.export`. Raises UnknownName, InvalidInput (for a folder of another dataset, too),
    Unsupported where the method cannot serve the rig, Unavailable where this machine cannot render.
    """
    from rectbench.applications.export.exporting import Export, export_dataset
    from rectbench.progress import progress_for
    from rectbench.runs.record import check_writable

    check_writable(Path(out))
    checked = [_checked_seed(seed) for seed in dict.fromkeys(seeds)]
    if not checked:
        raise InvalidInput("seeds are empty; expected whole numbers from 0 on, a pair each")
    export = Export(
        scene_source=str(Path(scene).resolve()) if is_path(scene) else str(scene),
        rig=rig if isinstance(rig, Rig) else load_rig(rig),
        motion=motion,
        spp=spp,
        quality=quality,
        image_width=_checked_width(image_width),
        method=str(method),
        options=options or {},
    )
    return export_dataset(export, checked, Path(out), progress_for(progress))


def run(
    report: Report | str | Path,
    out: str | Path | None = None,
    methods: Sequence[str] | None = None,
    scenes: Sequence[str] | None = None,
    rigs: Sequence[str] | None = None,
    seeds: Sequence[int] | None = None,
    data: str | Path | None = None,
    options: Mapping[str, Mapping[str, Any]] | None = None,
    jobs: int | None = None,
    dask: str | None = None,
    fresh: bool = False,
    progress: bool | None = None,
) -> pd.DataFrame:
    """Run a report and write its folder: results, tables, figures and `index.html`.

    A report of photographs, such as "real", takes them from the folder `data`.

    The arguments are those of `runs.making.run`. Returns the rows of `results.parquet`.
    """
    from rectbench.progress import progress_for
    from rectbench.reporting import write_report
    from rectbench.runs import making

    table = making.run(
        report,
        out,
        methods=methods,
        scenes=scenes,
        rigs=rigs,
        seeds=seeds,
        data=data,
        options=options,
        jobs=jobs,
        dask=dask,
        fresh=fresh,
        progress=progress,
    )
    write_report(making.run_folder(report, out), progress=progress_for(progress))
    return table


def _checked_seed(seed: Any) -> int:
    if isinstance(seed, bool) or not isinstance(seed, int | np.integer) or seed < 0:
        raise InvalidInput(f"seed is {seed!r}; expected a whole number from 0 on")
    return int(seed)


def _checked_width(image_width: Any) -> int | None:
    if image_width is None:
        return None
    if not isinstance(image_width, int | np.integer) or image_width < 1:
        raise InvalidInput(f"image_width is {image_width!r}; expected a width in pixels")
    return int(image_width)


def _checked_positive(value: Any, name: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float | np.number) or not 0 < value < np.inf:
        raise InvalidInput(f"{name} is {value!r}; expected a number above 0")
    return float(value)


def _checked_pixels(pixels: ArrayLike, name: str) -> FloatArray:
    try:
        points = np.asarray(pixels, dtype=np.float64)
    except (TypeError, ValueError):
        raise InvalidInput(f"{name} are no numbers; expected [N, 2] pixels") from None
    if points.ndim != 2 or points.shape[1] != 2 or not len(points):
        raise InvalidInput(f"{name} have shape {points.shape}; expected [N, 2]")
    if not np.isfinite(points).all():
        raise InvalidInput(f"{name} hold NaN or infinity; expected finite pixels")
    return points


def _checked_matches(matches: Sequence[ArrayLike]) -> Matches:
    if not isinstance(matches, Sequence) or len(matches) != 2:
        raise InvalidInput(f"matches {_held(matches)}; expected (left [N, 2], right [N, 2])")
    left, right = (_checked_pixels(px, f"{side} matches") for px, side in zip(matches, SIDES, strict=True))
    if left.shape != right.shape:
        raise InvalidInput(f"matches have {len(left)} left and {len(right)} right pixels; expected as many")
    return Matches(left, right)


def _held(given: object) -> str:
    return f"hold {len(given)} arrays" if isinstance(given, Sequence) else f"are {type(given).__name__}"


def _checked_images(images: StereoPair | Sequence[ArrayLike], rig: Rig) -> Images:
    given: list[Any] = []
    if hasattr(images, "left") and hasattr(images, "right"):
        given = [images.left, images.right]
    elif isinstance(images, Sequence):
        given = list(images)
    if len(given) != 2:
        raise InvalidInput(f"images {_held(images)}; expected (left, right)")
    arrays: list[NDArray[np.generic]] = [np.asarray(image) for image in given]
    for side, image in zip(SIDES, arrays, strict=True):
        camera = getattr(rig, side)
        if image.ndim not in (2, 3) or image.shape[:2] != (camera.height, camera.width):
            size = "x".join(map(str, image.shape[1::-1]))
            expected = f"{camera.width}x{camera.height}, the size of rig {rig.name}'s camera"
            raise InvalidInput(f"the {side} image is {size} px; expected {expected}")
    return Images(*arrays)
