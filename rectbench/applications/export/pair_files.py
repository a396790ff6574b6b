"""The files of one pair of a dataset: contents by path, `NAME` being the pair's in each."""

from __future__ import annotations

from typing import Any

import numpy as np

from rectbench.applications.export import file_formats as encode
from rectbench.applications.rectification_files import SIDES, Files, description_files
from rectbench.cameras import Camera
from rectbench.errors import InvalidInput
from rectbench.images.reading import encoded
from rectbench.images.stereo_pair import StereoPair
from rectbench.rendering.rectified_truth import RectifiedTruth
from rectbench.rendering.truth import Truth
from rectbench.rigs import Rig
from rectbench.rigs.saving import calibration_texts

CALIBRATIONS = {"native": "rig.yaml", "kalibr": "kalibr.yaml", "opencv": "opencv.yml"}
"""The formats of a pair's calibration, as far as they hold its lenses, and the names of their files."""

WIDEST_Z_DEG = 80.0
"""A camera that looks farther off its axis gets no depth along z: towards 90° that is 0 for any point."""


def image_files(images: StereoPair, name: str) -> Files:
    """The rendered images: `left/NAME.png`, `right/NAME.png`."""
    return {f"{side}/{name}.png": encoded(getattr(images, side)) for side in SIDES}


def truth_files(truth: Truth, name: str) -> Files:
    """Depth and visibility at the pixels of both images, and the flow from the left one to the right one."""
    files: Files = {}
    for side in SIDES:
        depth, points = getattr(truth, f"depth_{side}"), getattr(truth, f"points_{side}")
        files |= _float_files(f"depth_{side}/{name}", depth)
        files[f"depth_mm_{side}/{name}.png"] = encode.millimetres_png(depth)
        if has_z_depth(getattr(truth.rig, side)):
            files |= _float_files(f"z_{side}/{name}", points[..., 2])
        files[f"visible_{side}/{name}.png"] = encode.mask_png(getattr(truth, f"visible_{side}"))
    flow = truth.px_right_of_left - truth.rig.left.pixel_grid()
    return files | {f"flow/{name}.flo": encode.flo(flow)}


def rectified_files(images: StereoPair, truth: RectifiedTruth, method: str, name: str) -> Files:
    """The rectified images, their masks and description, and the disparity of the left one."""
    rect, files = truth.rect, {}
    for side, image in zip(SIDES, rect.remap(images.left, images.right), strict=True):
        files[f"rectified/{side}/{name}.png"] = encoded(image)
        files[f"rectified/mask_{side}/{name}.png"] = encode.mask_png(rect.valid(side))
    disparity = shown_disparity(truth)
    matched = np.where(truth.matched, disparity, np.nan)
    described = description_files(rect, method=method)
    return {
        **files,
        f"disparity/{name}.pfm": encode.pfm(np.where(np.isfinite(disparity), disparity, np.inf)),
        f"disparity_occ/{name}.png": encode.kitti_png(disparity),
        f"disparity_noc/{name}.png": encode.kitti_png(matched),
        f"matched/{name}.png": encode.mask_png(np.isfinite(matched)),
        **{f"rectified/description/{name}/{file}": content for file, content in described.items()},
    }


def calibration_files(rig: Rig, name: str) -> tuple[Files, dict[str, str]]:
    """The rig in each of `CALIBRATIONS` that holds its lenses; by format, why another does not."""
    files: Files = {}
    refused: dict[str, str] = {}
    for format, file in CALIBRATIONS.items():
        try:
            texts = calibration_texts(rig, file, format)
        except InvalidInput as reason:
            refused[format] = str(reason)
        else:
            files |= {f"calibration/{name}/{part}": text.encode() for part, text in texts.items()}
    return files, refused


def shown_disparity(truth: RectifiedTruth) -> encode.FloatMap:
    """The disparity [H, W] at the pixels that show nothing but the left image; NaN elsewhere."""
    return np.where(truth.rect.valid("left"), truth.disparity_px, np.nan)


def has_z_depth(camera: Camera) -> bool:
    """Whether every pixel looks less than `WIDEST_Z_DEG` off the axis, so that z says how far a point is."""
    rays, _ = camera.unproject(camera.pixel_grid())
    return bool(np.nanmin(rays[..., 2]) > np.cos(np.radians(WIDEST_Z_DEG)))


def pair_facts(truth: Truth, rectified: RectifiedTruth) -> dict[str, Any]:
    """The numbers of a pair that the dataset's index tells."""
    disparity = shown_disparity(rectified)
    known = np.isfinite(disparity)
    return {
        "left_size": list(truth.rig.left.size),
        "right_size": list(truth.rig.right.size),
        "rectified_size": list(rectified.rect.size),
        "baseline_m": truth.rig.baseline_m,
        "depth_m": _range(truth.depth_left),
        "disparity_px": _range(disparity),
        "row_difference_px": rectified.row_difference_px,
        "visible_left_share": float(truth.visible_left.mean()),
        "matched_share": float((rectified.matched & known).mean()),
        "outside_kitti": int((known & ~encode.fits_kitti(disparity)).sum()),
    }


def _range(values: encode.FloatMap) -> list[float] | None:
    """Least and greatest finite value; None where there is none."""
    finite = values[np.isfinite(values)]
    return [float(finite.min()), float(finite.max())] if finite.size else None


def _float_files(stem: str, values: encode.FloatMap) -> Files:
    return {f"{stem}.exr": encode.exr(values), f"{stem}.pfm": encode.pfm(values)}
