"""The verbs of `import rectbench as rb`: estimate a pose, rectify a rig, render or export, run a report.

Their arguments are the fields of requests, which the command line fills too and which check them, see
`applications.requests`. Imports all but cli.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from numpy.typing import ArrayLike

from rectbench.applications.one_rig import checked_rig, estimate_rig_pose, rectify_rig
from rectbench.applications.requests.photographs import PoseSettings, RectifyRequest
from rectbench.applications.requests.rendering import ExportRequest, RenderRequest
from rectbench.applications.requests.request import SeededMethodRequest
from rectbench.applications.requests.running import PlanRequest, RunRequest
from rectbench.calibrations.reading import RigSource
from rectbench.margin import MARGIN_DEG
from rectbench.matching.features.matches import RATIO
from rectbench.matching.pose.estimate import POSE_PIXELS, PoseEstimate
from rectbench.plugins.defaults import DEFAULT_METHOD
from rectbench.rigs import Rig
from rectbench.warps import Framing, Rectification

if TYPE_CHECKING:
    import pandas as pd

    from rectbench.applications.export.dataset import Exported
    from rectbench.applications.photographs.rectified import RectifiedImages
    from rectbench.experiments.spec import Report
    from rectbench.images.stereo_pair import StereoPair
    from rectbench.rendering.truth import Truth
    from rectbench.runs.designing import Design


def rectify(
    rig: Rig,
    method: str | Path = DEFAULT_METHOD,
    images: StereoPair | Sequence[ArrayLike] | None = None,
    pixels: ArrayLike | None = None,
    matches: Sequence[ArrayLike] | None = None,
    seed: int = 0,
    margin_deg: float = MARGIN_DEG,
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
    margin_deg : nearer to the epipoles than this, where rows meet, the view is trimmed: the method is handed
        lenses that see nothing there, see `Rig.trimmed`.
    options : the method's own (`rectbench list methods --verbose`).

    Returns the rectification, see `Rectification`. Raises UnknownName for a method or option that
    does not exist; InvalidInput for an argument that cannot be used; Unsupported, with the reason,
    where the method cannot serve this rig, or its two views have nothing in common; InvalidResult where a
    plugin's answer is no rectification.

    >>> import rectbench as rb
    >>> rig = rb.load_rig("sony-as200v").scaled(0.1)
    >>> rect = rb.rectify(rig, "abraham", law="equisolid")
    >>> rect.size
    (131, 121)
    >>> rect.left.forward([[80.0, 50.0]]).shape
    (1, 2)
    """
    request = SeededMethodRequest(method=method, options=options, seed=seed, margin_deg=margin_deg)
    return rectify_rig(checked_rig(rig), request, images=images, pixels=pixels, matches=matches)


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
    margin_deg: float = MARGIN_DEG,
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
    margin_deg : nearer to the epipoles than this the view is trimmed, see `rectify`.
    max_angle_deg, unit, cameras : the lenses' image circle, what translations are in, and which two
        cameras are meant, where the calibration does not tell. An image circle that nobody states is read
        from a mask beside images or calibration, or from the black rim; see the result's `circle`.
    progress : a bar on stderr; where there are several pairs and a terminal by default.

    Returns what was made; see `rectbench.applications.photographs.rectify` for the files, and for what
    is raised.

    >>> import tempfile, cv2, numpy as np, rectbench as rb
    >>> rig, folder = rb.load_rig("sony-as200v").scaled(0.1), Path(tempfile.mkdtemp())
    >>> width, height = rig.left.size
    >>> for side in ("left", "right"):
    ...     _ = cv2.imwrite(str(folder / f"{side}.png"), np.zeros((height, width, 3), np.uint8))
    >>> made = rb.rectify_images(
    ...     folder / "left.png", folder / "right.png", rig, folder / "out", tables=["npz"], measured_pairs=0
    ... )
    >>> made.method, (folder / "out" / "maps.npz").exists()
    ('local-homography', True)
    """
    given = {name: value for name, value in locals().items() if name not in ("framing", "progress")}
    from rectbench.applications.photographs.rectify import rectify_photographs

    return rectify_photographs(RectifyRequest(**given, **vars(framing or Framing())), progress)


def write_tables(
    rig: Rig | RigSource | Sequence[RigSource],
    out: str | Path = "rectified",
    *,
    method: str | Path | None = None,
    options: Mapping[str, Any] | None = None,
    framing: Framing | None = None,
    tables: Sequence[str] = ("npz", "opencv", "fixed"),
    seed: int = 0,
    image_size: tuple[int, int] | None = None,
    max_angle_deg: float | None = None,
    unit: str | None = None,
    cameras: Sequence[str] | None = None,
) -> RectifiedImages:
    """Rectify a rig into a folder, without images: lookup tables, masks, descriptions, metrics.

    Parameters
    ----------
    rig, out, method, options, framing, tables, seed, max_angle_deg, unit, cameras : as in `rectify_images`.
        A method that works from matches gets exact ones, made from the rig's pose.
    image_size : (width, height) of the source images, pixels, for a calibration that does not tell.

    Written are the same files but for the images; `preview.png` shows a grid of source pixels. Returns what
    was made. Raises what `rectify_images` raises; Unsupported for a method that works from images.

    >>> import tempfile, rectbench as rb
    >>> folder = Path(tempfile.mkdtemp())
    >>> made = rb.write_tables(rb.load_rig("sony-as200v").scaled(0.1), folder, tables=["npz"])
    >>> sorted(file.name for file in made.files)
    ['left_mask.png', 'maps.npz', 'metrics.json', 'preview.png', 'rectified.yaml', 'right_mask.png']
    """
    given = {name: value for name, value in locals().items() if name != "framing"}
    from rectbench.applications.photographs.rectify import rectify_photographs

    return rectify_photographs(RectifyRequest(**given, **vars(framing or Framing())))


def estimate_pose(
    images: StereoPair | Sequence[ArrayLike],
    rig: Rig,
    *,
    detector: str = "sift",
    ratio: float = RATIO,
    farthest: float | None = None,
    working_pixels: float | None = POSE_PIXELS,
    search: str = "ransac",
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
    search : for the pose that matches agree on: `ransac`, from random samples of five; `inlier-set`, the one
        that most of 60 of them agree on, of all whose rotation is within 30° of none, by branch and bound:
        some ten seconds (Yang, Li and Jia 2014).
    seed : of the random samples; the same seed gives the same pose to the last bit.

    Returns the pose, with its covariance and the matches it explains; its `note` says where it
    contradicts the rig's own pose, as that of swapped images does. `estimate.rig(rig)` is the rig
    in that pose. Raises PoseNotFound, with the reason, where the images tell no pose: too few
    matches, none that agree, or a turn alone; InvalidInput for images that are not this rig's.

    >>> import cv2, rectbench as rb
    >>> rig = rb.load_rig("t265")
    >>> images = [cv2.imread(f"{side}.png") for side in ("left", "right")]  # doctest: +SKIP
    >>> rig = rb.estimate_pose(images, rig).rig(rig)  # doctest: +SKIP
    >>> rb.estimate_pose([], rig, ratio=0)
    Traceback (most recent call last):
    rectbench.errors.InvalidInput: ratio is 0; expected a number above 0
    """
    settings = PoseSettings(
        detector=detector,
        ratio=ratio,
        farthest=farthest,
        working_pixels=working_pixels,
        search=search,
        seed=seed,
    )
    return estimate_rig_pose(images, checked_rig(rig), settings)


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

    >>> import rectbench as rb
    >>> pair, truth = rb.render("street", "t265", seed=1, image_width=400)  # doctest: +SKIP
    >>> px_left, px_right = truth.matches(4000)  # doctest: +SKIP
    >>> rb.render("street", "t265", image_width=0)
    Traceback (most recent call last):
    rectbench.errors.InvalidInput: image_width is 0; expected a width in pixels
    """
    request = RenderRequest(**locals())
    from rectbench.applications.render import render

    return render(request)


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
    margin_deg: float = MARGIN_DEG,
    progress: bool | None = None,
) -> Exported:
    """Render a dataset that other tools open: a pair a seed, the truth about it, and its rectification.

    Parameters
    ----------
    scene, rig, motion, spp, quality, image_width : as in `render`, which gives the same images for a seed.
    out : the dataset's folder; what of the same dataset is whole there already is kept.
    seeds : a pair each.
    method, options : what rectifies the pairs, from their true rig; a method that works from the pose.
    margin_deg : nearer to the epipoles than this the view is trimmed, see `rectify`.
    progress : a bar on stderr; on a terminal by default.

    Written are images, depth, visibility and flow; the rectified pair with its masks and exact disparity;
    calibrations; `README.md`, which says what each file holds and how it is read, and `dataset.json`. See
    `rectbench.applications.export`. Raises UnknownName, InvalidInput (for a folder of another dataset, too),
    Unsupported where the method cannot serve the rig, Unavailable where this machine cannot render.

    >>> import rectbench as rb
    >>> made = rb.export_dataset("street", "t265", "dataset", seeds=[0, 1])  # doctest: +SKIP
    >>> rb.export_dataset("street", "t265", "dataset", seeds=[])
    Traceback (most recent call last):
    rectbench.errors.InvalidInput: seeds is empty; expected whole numbers from 0 on, a pair each
    """
    given = {name: value for name, value in locals().items() if name != "progress"}
    from rectbench.applications.export.dataset import export_dataset

    return export_dataset(ExportRequest(**given), progress)


def run(
    report: Report | str | Path,
    out: str | Path | None = None,
    methods: Sequence[str] | None = None,
    scenes: Sequence[str] | None = None,
    rigs: Sequence[str] | None = None,
    seeds: Sequence[int] | None = None,
    data: str | Path | None = None,
    options: Mapping[str, Mapping[str, Any]] | None = None,
    margin_deg: float | None = None,
    jobs: int | None = None,
    dask: str | None = None,
    fresh: bool = False,
    progress: bool | None = None,
) -> pd.DataFrame:
    """Run a report and write its folder: results, tables, figures and `index.html`.

    Parameters
    ----------
    report : a report's name, path, or the report itself.
    out : the run's folder; `runs/<report>` by default.
    methods, scenes, rigs, seeds : what to run in the place of the report's own; names or paths. A "+"
        before a name adds it to the report's own. Lenses without a scene run whatever `scenes` says, alone if
        it says "none".
    data : the folder of photographs, for a report that takes them, such as "real".
    options : options by method and name, laid over the report's.
    margin_deg : nearer to the epipoles than this views are trimmed, see `rectify`; the report's own margin by
        default.
    jobs : worker processes; as many as there are cores by default.
    dask : the address of a dask scheduler, on whose cluster it runs.
    fresh : make again what the store has of this run.
    progress : bars on stderr; on a terminal alone by default.

    Returns the rows of `results.parquet`. Raises InvalidInput before anything runs where the report, a name,
    a file or an option cannot be used; Interrupted on Ctrl-C.

    >>> import rectbench as rb
    >>> table = rb.run("quick", methods=["+my_rectifier.py"], jobs=2)  # doctest: +SKIP
    >>> rb.run("quick", jobs=0)
    Traceback (most recent call last):
    rectbench.errors.InvalidInput: jobs is 0; expected a whole number from 1 on
    """
    given = {name: value for name, value in locals().items() if name != "progress"}
    from rectbench.applications.run_report import run_report

    return run_report(RunRequest(**given), progress)


def plan(
    report: Report | str | Path,
    detect: float | str = "2%",
    metric: str | None = None,
    run: str | Path | None = None,
) -> Design:
    """How many rigs, scenes and seeds would tell a difference between two methods, by a run that is there.

    Parameters
    ----------
    report : a report's name, path, or the report itself.
    detect : the relative difference to be told: "2%", or 0.02.
    metric : the column that is compared, such as "row_error_mean_px"; by default the one that methods
        are ranked by.
    run : the folder of a run of the report; `runs/<report>` by default.

    Returns the design, whose `table` has a row for each pair of methods; see `rectbench.runs.designing`.
    Raises InvalidInput where there is no run yet, UnknownName for a column that it does not have.

    >>> import rectbench as rb
    >>> table = rb.plan("quick", detect="5%").table  # doctest: +SKIP
    >>> rb.plan("quick", detect=0)
    Traceback (most recent call last):
    rectbench.errors.InvalidInput: detect is 0; expected a percentage above 0 such as 2%
    """
    request = PlanRequest(**locals())
    from rectbench.applications.plan_report import plan_report

    return plan_report(request)
