"""The verb that rectifies image pairs of one's own."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from rectbench.cli.app import INCOMPLETE, Cameras, MaxAngle, MethodOptions, MethodSeed, Unit, split_names
from rectbench.cli.number_texts import image_size, numbers_in, two_numbers
from rectbench.errors import InvalidInput

LeftImages = Annotated[str, typer.Argument(metavar="LEFT", help="The left image, folder or pattern.")]
RightImages = Annotated[str, typer.Argument(metavar="RIGHT", help="The right one.")]


def rectify(
    left: LeftImages,
    right: RightImages,
    rig: Annotated[
        list[str] | None,
        typer.Option(
            metavar="CALIB",
            help="The rig's calibration file or folder, or a rig's name; repeatable where files are several. "
            "Without one, methods that work from matches alone.",
        ),
    ] = None,
    out: Annotated[Path, typer.Option("--out", "-o", help="Folder for what is made.")] = Path("rectified"),
    method: Annotated[
        str | None,
        typer.Option(
            "--method",
            "-m",
            help="A method's name, or a file; or best: all that apply are measured, each showing --coverage "
            "of the source pixels (95 % where not given), and the least log distortion is chosen. "
            "local-homography by default, hartley without a calibration.",
        ),
    ] = None,
    option: MethodOptions = None,
    seed: MethodSeed = 0,
    max_angle_deg: MaxAngle = None,
    unit: Unit = None,
    cameras: Cameras = None,
    crop: Annotated[
        str | None,
        typer.Option(
            metavar="valid|X,Y,W,H",
            help="Show the largest rectangle in which both images are valid, or one in pixels.",
        ),
    ] = None,
    fov: Annotated[
        str | None, typer.Option(metavar="DEGxDEG", help="Show a field of view, across and down, degrees.")
    ] = None,
    coverage: Annotated[
        float | None, typer.Option(metavar="SHARE", help="Show this share of the source pixels, up to 1.")
    ] = None,
    size: Annotated[
        str | None, typer.Option(metavar="WxH", help="Size of the rectified images, pixels.")
    ] = None,
    focal: Annotated[
        str | None,
        typer.Option(
            metavar="PX|source", help="Pixels per radian in the middle, or those of the source images there."
        ),
    ] = None,
    pixels: Annotated[
        float | None, typer.Option(metavar="NUMBER", help="Budget: a larger image is made smaller.")
    ] = None,
    antialias: Annotated[
        bool, typer.Option("--antialias", help="Average over a pixel's footprint where the image shrinks.")
    ] = False,
    tables: Annotated[
        str,
        typer.Option(
            metavar="KINDS", help="Lookup tables: npz, opencv, fixed, separated by commas; or none."
        ),
    ] = "npz,opencv,fixed",
    measure: Annotated[
        int, typer.Option(metavar="PAIRS", min=0, help="Measure the rows of so many pairs, spread over all.")
    ] = 5,
) -> None:
    """Rectify image pairs: images, masks, lookup tables, the rig's description, and what the frame costs.

    LEFT and RIGHT are two images, two folders, or two patterns such as 'left/*.png' in quotation marks.
    Exit code 3 where some of several pairs had to be left out.
    """
    from rectbench import api
    from rectbench.cli import printing as terminal
    from rectbench.cli.configuring import read_method_options
    from rectbench.warps import Framing

    made = api.rectify_images(
        left,
        right,
        rig,
        out,
        method=method,
        options=read_method_options(option),
        framing=Framing(
            crop=_crop(crop),
            fov_deg=two_numbers(fov, "fov", "two angles such as 100x80"),
            coverage=coverage,
            size=image_size(size),
            focal_px=_focal(focal),
            pixels=pixels,
        ),
        antialias=antialias,
        tables=[] if tables == "none" else split_names([tables]) or [],
        measured_pairs=measure,
        seed=seed,
        max_angle_deg=max_angle_deg,
        unit=unit,
        cameras=split_names(cameras),
    )
    terminal.show_rectified(made)
    if made.left_out:
        raise typer.Exit(INCOMPLETE)


def _crop(text: str | None) -> Literal["valid"] | tuple[float, float, float, float] | None:
    if text is None or text == "valid":
        return text  # type: ignore[return-value]  # mypy does not narrow a str to a literal
    numbers = numbers_in(text.split(","))
    if numbers is None or len(numbers) != 4:
        raise InvalidInput(f"crop is {text}; expected valid, or x,y,width,height in pixels")
    return numbers[0], numbers[1], numbers[2], numbers[3]


def _focal(text: str | None) -> float | Literal["source"] | None:
    if text is None:
        return None
    if text == "source":
        return "source"
    numbers = numbers_in([text])
    if numbers is None:
        raise InvalidInput(f"focal is {text}; expected a number of pixels, or source")
    return numbers[0]
