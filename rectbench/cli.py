"""The command line. Every verb is a few lines over the Python call of the same name.

Modules are imported by the verb that needs them, so that `rectbench --help` is there at once.
Exit codes: 0 good, 1 a regression or a failed check, 2 wrong usage or a broken environment,
3 incomplete or nothing measured.
"""

from __future__ import annotations

import logging
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from rectbench.errors import InvalidInput, RectbenchError, UnknownName

if TYPE_CHECKING:
    import pandas as pd

    from rectbench.rendering.images import StereoPair
    from rectbench.warps import Rectification

WRONG_USAGE, INCOMPLETE = 2, 3
KINDS = ("methods", "scenes", "rigs", "motions", "poses", "reports", "formats")

app = typer.Typer(
    help="A bench for stereo rectification: render, rectify, measure, report.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,  # square brackets in help texts are TOML sections
)

ManyNames = Annotated[list[str] | None, typer.Option(metavar="NAMES")]
RunFolder = Annotated[Path, typer.Argument(metavar="RUN", help="A run's folder.")]
OptionTexts = Annotated[
    list[str] | None,
    typer.Option("--option", metavar="METHOD.NAME=VALUE", help="An option of a method; repeatable."),
]
LeftImage = Annotated[Path, typer.Argument(metavar="LEFT", help="The left image.")]
RightImage = Annotated[Path, typer.Argument(metavar="RIGHT", help="The right image.")]
RigFiles = Annotated[
    list[str],
    typer.Option(
        metavar="CALIB",
        help="The rig's calibration file or folder, or a rig's name; repeatable where files are several.",
    ),
]
MaxAngle = Annotated[
    float | None, typer.Option(help="The image circle: the lenses show nothing beyond this angle.")
]
Method = Annotated[str, typer.Option("--method", "-m", help="A method's name, or a file.")]
MethodOptions = Annotated[
    list[str] | None,
    typer.Option("--option", metavar="NAME=VALUE", help="An option of the method; repeatable."),
]
MethodSeed = Annotated[int, typer.Option(help="Of the method's random choices.")]
Unit = Annotated[
    str | None,
    typer.Option(help="What the calibration's translations are in, if not metres: mm, cm, in or ft."),
]


def main() -> None:
    """Run the command line; a known error is one line on stderr."""
    logging.basicConfig(format="rectbench: %(message)s", level=logging.WARNING)
    try:
        status = app(standalone_mode=False)
    except (RectbenchError, OSError) as error:
        status = _complain(error)
    except Exception as error:
        # Typer ships its own copy of Click or uses the installed one: usage errors are known by shape.
        message = getattr(error, "format_message", None)
        if message is None:
            raise
        status = _complain(message())
    sys.exit(status if isinstance(status, int) else 0)


def _complain(error: object) -> int:
    if str(error):  # without a verb there is only the help, printed already
        print(f"rectbench: {' '.join(str(error).split())}", file=sys.stderr)
    return WRONG_USAGE


@app.command("list")
def list_(
    kind: Annotated[str | None, typer.Argument(metavar="KIND", help=f"One of {', '.join(KINDS)}.")] = None,
    verbose: Annotated[bool, typer.Option("--verbose", "-v", help="With options and references.")] = False,
) -> None:
    """List methods, scenes, rigs, motions, poses and reports, and the plugins that cannot be loaded."""
    from rectbench import terminal

    if kind is not None and kind not in KINDS:
        raise UnknownName("kind", kind, KINDS)
    for chosen in KINDS if kind is None else (kind,):
        terminal.show_names(chosen, verbose)


@app.command()
def run(
    report: Annotated[
        str, typer.Argument(metavar="REPORT", help="A report's name, or the path of its file.")
    ],
    out: Annotated[Path | None, typer.Option(help="The run's folder; runs/REPORT by default.")] = None,
    methods: Annotated[
        list[str] | None,
        typer.Option(metavar="NAMES", help="Run these in the place of the report's own, +NAME beside them."),
    ] = None,
    scenes: Annotated[list[str] | None, typer.Option(metavar="NAMES", help="Likewise.")] = None,
    rigs: Annotated[list[str] | None, typer.Option(metavar="NAMES", help="Likewise.")] = None,
    seeds: Annotated[
        list[str] | None, typer.Option(metavar="NUMBERS", help="Likewise, such as 0,1,2.")
    ] = None,
    jobs: Annotated[int | None, typer.Option(help="Worker processes; one a core by default.")] = None,
    dask: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="Run on this dask scheduler's cluster.")
    ] = None,
    fresh: Annotated[
        bool | None, typer.Option("--fresh", help="Make again what the store has of this run.")
    ] = None,
    config: Annotated[
        Path | None, typer.Option(help="TOML with [run] and [methods.NAME]; the command line wins.")
    ] = None,
    option: OptionTexts = None,
) -> None:
    """Run a report: render, rectify, measure, and write tables, figures and a page.

    Names are separated by commas, and may be paths of files. A run that was cut off goes on where it
    was; what is in the store is not done again.
    """
    from rectbench import api, terminal
    from rectbench.bench.configuring import overlaid, read_config, read_options
    from rectbench.bench.running import Interrupted, run_folder

    settings, options = read_config(config) if config else ({}, {})
    said = {
        "out": out,
        "methods": _split(methods),
        "scenes": _split(scenes),
        "rigs": _split(rigs),
        "seeds": _numbers(seeds),
        "jobs": jobs,
        "dask": dask,
        "fresh": fresh,
    }
    settings |= {name: value for name, value in said.items() if value is not None}
    options = overlaid(options, read_options(option or []))
    try:
        table = api.run(report, options=options, **settings)
    except Interrupted as interruption:
        print(f"rectbench: {interruption}", file=sys.stderr)
        raise typer.Exit(INCOMPLETE) from None
    folder = run_folder(report, settings.get("out"))
    terminal.show_summary(folder)
    if not (table["status"] == "ok").any():
        print(f"rectbench: nothing was measured; {_first_reason(table)}", file=sys.stderr)
        raise typer.Exit(INCOMPLETE)


@app.command()
def report(folder: RunFolder) -> None:
    """Write the tables, figures and page of a run again."""
    from rectbench import terminal
    from rectbench.bench.progress import progress_for
    from rectbench.reporting import write_report

    write_report(folder, progress=progress_for(None))
    terminal.show_summary(folder)


@app.command()
def gate(
    folder: RunFolder,
    accepted: Annotated[
        Path | None, typer.Option(help="The accepted numbers; beside the report's file by default.")
    ] = None,
    accept: Annotated[
        bool, typer.Option("--accept", help="Make the run's numbers the accepted ones.")
    ] = False,
) -> None:
    """Compare a run with the numbers accepted for its report.

    Exit code 0 where it is as good, 1 where it got worse, 3 where it is incomplete or measured nothing.
    """
    from rectbench import terminal
    from rectbench.bench import gating

    path = accepted or gating.accepted_path(folder)
    if accept:
        print(f"{gating.accept(folder, path)} cells accepted in {path}")
        return
    verdict = gating.gate(folder, path)
    terminal.show_verdict(verdict)
    raise typer.Exit(verdict.exit_code)


@app.command()
def compare(
    a: Annotated[Path, typer.Argument(metavar="A", help="A run's folder.")],
    b: Annotated[Path, typer.Argument(metavar="B", help="Another.")],
    metrics: Annotated[list[str] | None, typer.Option(metavar="NAMES", help="Only these columns.")] = None,
) -> None:
    """Compare two runs cell by cell: the median change B - A of every metric, with its 95 % interval."""
    from rectbench import terminal
    from rectbench.bench import comparing

    comparison = comparing.compare(a, b)
    if comparison.table.empty:
        print("rectbench: no cell was measured in both runs", file=sys.stderr)
    chosen = _split(metrics)
    known = set(comparison.table["metric"])
    for name in chosen or []:
        if name not in known:
            raise UnknownName("metric", name, known)
    terminal.show_comparison(comparison, chosen)
    raise typer.Exit(INCOMPLETE if comparison.table.empty else 0)


@app.command()
def render(
    scene: Annotated[
        str, typer.Argument(metavar="SCENE", help="A scene's name, or a .py or Mitsuba .xml file.")
    ],
    rig: Annotated[str, typer.Argument(metavar="RIG", help="A rig's name, or a calibration file.")],
    out: Annotated[Path, typer.Option("--out", "-o", help="Folder for images, truth and rig.")] = Path(
        "rendered"
    ),
    motion: Annotated[str, typer.Option(help="How the right camera stands to the left.")] = "as-calibrated",
    seed: Annotated[int, typer.Option(help="Of scene, motion and noise.")] = 0,
    spp: Annotated[int, typer.Option(help="Samples a pixel, a power of two.")] = 64,
    quality: Annotated[str, typer.Option(help="path or fast.")] = "path",
    width: Annotated[int | None, typer.Option(help="Scale the rig to this image width, pixels.")] = None,
) -> None:
    """Render a rig in a scene: left.png, right.png, truth.npz, truth EXRs and rig.yaml."""
    from rectbench import api
    from rectbench.bench.run_folder import check_writable

    check_writable(out)
    pair, truth = api.render(scene, rig, motion, seed, spp, quality, width)
    pair.save(out)
    truth.save(out / "truth.npz")
    truth.save_exr(out)
    truth.rig.save(out / "rig.yaml")
    print(out)


@app.command()
def rectify(
    left: LeftImage,
    right: RightImage,
    rig: RigFiles,
    out: Annotated[Path, typer.Option("--out", "-o", help="Folder for what is made.")] = Path("rectified"),
    method: Method = "local-homography",
    option: MethodOptions = None,
    seed: MethodSeed = 0,
    max_angle_deg: MaxAngle = None,
    unit: Unit = None,
) -> None:
    """Rectify an image pair: rectified images, masks, lookup tables and a preview with scan lines."""
    from rectbench.bench.rectified_files import write_rectified

    pair, rectification = _rectified(left, right, rig, method, option, seed, max_angle_deg, unit)
    for file in write_rectified(rectification, pair, out):
        print(file)


@app.command()
def pose(
    left: LeftImage,
    right: RightImage,
    rig: RigFiles,
    out: Annotated[
        Path | None, typer.Option("--out", "-o", metavar="FILE", help="Write the rig in this pose as YAML.")
    ] = None,
    detector: Annotated[str, typer.Option(help="Of features: sift, akaze, orb or surf.")] = "sift",
    seed: Annotated[int, typer.Option(help="Of the random samples.")] = 0,
    max_angle_deg: MaxAngle = None,
    unit: Unit = None,
) -> None:
    """Estimate from an image pair how the right camera stands to the left one.

    The calibration gives the two lenses and the length of the baseline; its own pose is compared with
    the estimate.
    """
    from rectbench import api, terminal
    from rectbench.matching.images import read_images
    from rectbench.rigs import load_rig

    images = read_images(left, right)
    calibrated = load_rig(rig[0] if len(rig) == 1 else rig, size=images.left.shape[1::-1], unit=unit)
    if max_angle_deg is not None:
        calibrated = calibrated.within(max_angle_deg)
    estimate = api.estimate_pose(images, calibrated, detector=detector, seed=seed)
    terminal.show_pose(estimate, calibrated)
    if out is not None:
        estimate.rig(calibrated).save(out)
        print(out)


@app.command()
def reconstruct(
    left: LeftImage,
    right: RightImage,
    rig: RigFiles,
    out: Annotated[Path, typer.Option("--out", "-o", help="Folder for what is made.")] = Path(
        "reconstructed"
    ),
    method: Method = "local-homography",
    option: MethodOptions = None,
    seed: MethodSeed = 0,
    max_angle_deg: MaxAngle = None,
    unit: Unit = None,
    matcher: Annotated[
        str, typer.Option(help="The dense matcher: sgbm, sgbm-5way, sgbm-8way or bm.")
    ] = "sgbm",
    nearest_baselines: Annotated[
        float, typer.Option(help="Nothing nearer is sought, in multiples of the baseline.")
    ] = 4.0,
    pixels: Annotated[
        float, typer.Option(help="A rectified image of more pixels is made smaller first.")
    ] = 1e6,
) -> None:
    """Reconstruct an image pair in 3-D: a coloured point cloud, depth, disparity and a picture."""
    from rectbench.matching import reconstruct
    from rectbench.matching.matchers import matcher_named
    from rectbench.reporting.reconstructed import write_reconstruction

    matcher_named(matcher)  # a wrong name is told before the work begins
    pair, rectification = _rectified(left, right, rig, method, option, seed, max_angle_deg, unit)
    found = reconstruct(
        rectification, pair.left, pair.right, matcher, pixels=pixels, nearest_baselines=nearest_baselines
    )
    for file in write_reconstruction(found, out):
        print(file)


@app.command()
def check(
    plugin: Annotated[
        str, typer.Argument(metavar="PLUGIN", help="A method's name, or the path of its file.")
    ],
) -> None:
    """Run the conformance suite over a method; exit code 1 where a check fails."""
    from rectbench import terminal
    from rectbench.bench.conformance import check_method
    from rectbench.bench.plugins import registry

    method = registry("methods").get(plugin)
    failed = terminal.show_checks(method.name, check_method(method))
    raise typer.Exit(1 if failed else 0)


@app.command()
def doctor() -> None:
    """Tell what is there and what is missing; exit code 2 where rectbench cannot run."""
    from rectbench import terminal
    from rectbench.bench.doctor import examine

    raise typer.Exit(0 if terminal.show_examination(examine()) else WRONG_USAGE)


@app.command()
def gc(
    older_than: Annotated[
        float | None, typer.Option(metavar="DAYS", min=0, help="Remove what was not used for so long.")
    ] = None,
    larger_than: Annotated[
        float | None, typer.Option(metavar="GIB", min=0, help="Remove the longest unused beyond this size.")
    ] = None,
) -> None:
    """Remove rendered pairs and finished cells from the store; without options, tell its size."""
    from rectbench.bench.store import Store

    store = Store.default()
    if older_than is not None or larger_than is not None:
        removed = store.collect(older_than, None if larger_than is None else round(larger_than * 2**30))
        print(f"removed {len(removed)} objects, {sum(entry.size_bytes for entry in removed) / 2**20:.0f} MiB")
    entries = store.entries()
    print(
        f"{store.root}: {len(entries)} objects, {sum(entry.size_bytes for entry in entries) / 2**20:.0f} MiB"
    )


def _rectified(
    left: Path,
    right: Path,
    rig: list[str],
    method: str,
    option: list[str] | None,
    seed: int,
    max_angle_deg: float | None,
    unit: str | None,
) -> tuple[StereoPair, Rectification]:
    """The images of two files, and the rectification of their rig."""
    from rectbench import api
    from rectbench.bench.configuring import read_options
    from rectbench.rendering.images import StereoPair
    from rectbench.rigs import load_rig

    pair = StereoPair.read(left, right)
    calibrated = load_rig(rig[0] if len(rig) == 1 else rig, size=pair.left.shape[1::-1], unit=unit)
    if max_angle_deg is not None:
        calibrated = calibrated.within(max_angle_deg)
    options = read_options([f"method.{text}" for text in option or []]).get("method", {})
    return pair, api.rectify(calibrated, method, images=pair, seed=seed, **options)


def _split(names: list[str] | None) -> list[str] | None:
    """Names of repeated options and of comma-separated lists, in one list."""
    if names is None:
        return None
    return [name.strip() for text in names for name in text.split(",") if name.strip()]


def _numbers(texts: list[str] | None) -> list[int] | None:
    words = _split(texts)
    try:
        return None if words is None else [int(word) for word in words]
    except ValueError:
        raise InvalidInput(
            f"seeds are {','.join(words or [])}; expected whole numbers such as 0,1,2"
        ) from None


def _first_reason(table: pd.DataFrame) -> Any:
    row = table.iloc[0]
    return f"the first cell says {row['status']}: {row['reason']}"
