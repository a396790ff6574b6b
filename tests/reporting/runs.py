"""Run folders that look like real ones, and a world simple enough to draw without a renderer."""

from __future__ import annotations

import zlib
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from rectbench.cameras import Camera
from rectbench.experiments.selecting import Selection
from rectbench.experiments.spec import Report
from rectbench.images.stereo_pair import StereoPair
from rectbench.metrics import distortion
from rectbench.plugins.figure import Sources
from rectbench.rendering.truth import Truth
from rectbench.rigs import Rig
from rectbench.runs.record import VERSION, RunRecord, write_run
from rectbench.types import Matches
from rectbench.warps import Cubic, Epipolar, Perspective, Radial, Rectification

METHODS = {
    "conventional": (0.62, 0.9, 0.61),
    "abraham": (0.30, 0.2, 1.0),
    "hartley": (0.71, 1.4, 0.55),
    "fusiello": (0.66, 1.1, 0.58),
    "local-homography": (0.21, 0.06, 1.0),
}
"""Log distortion, distortion and coverage each method is about."""
SHARES = (10, 20, 30, 40, 50, 60, 70, 75, 80, 90, 95, 100)
PERSPECTIVE = ("conventional", "hartley", "fusiello")
VIEWS_DEG = {"t265": 160.0, "sony-hdr-as200v": 130.0, "perspective-wide": 70.0}
SCENES = ("street", "corridor", "room", "forest")
RIGS = ("t265", "sony-hdr-as200v", "perspective-wide")
SPHERE_M = 6.0


NOTES = {
    **dict.fromkeys(PERSPECTIVE, '{"projection": "perspective"}'),
    "abraham": '{"focal_px": 412.25, "lens_law": "equidistant"}',
}


def view_columns(rig: str, method: str, factor: float = 1.0) -> dict[str, float]:
    """Log distortion on growing shares of the view, next to none in the middle of perspective images."""
    whole, _, kept = METHODS.get(method, (0.5, 0.5, 0.9))
    power = 2.5 if method in PERSPECTIVE else 0.5
    columns = {"view_kept": min(1.0, kept)}
    for share in SHARES:
        value = factor * whole * (share / 100) ** power
        columns[f"log_distortion_{share}"] = value if share <= 100 * kept else float("nan")
        columns[f"view_{share}_deg"] = VIEWS_DEG.get(rig, 120.0) * (share / 100) ** 0.5
    return columns


def make_row(scene: str, rig: str, pose: str, method: str, seed: int = 0, **changes: Any) -> dict[str, Any]:
    """One ok row with plausible numbers that depend on its identity alone."""
    rng = np.random.default_rng(zlib.crc32(f"{scene}{rig}{pose}{method}{seed}".encode()))
    log_distortion, native, kept = METHODS.get(method, (0.5, 0.5, 0.9))
    jitter = float(rng.uniform(0.8, 1.25))
    exact = pose == "exact" and method not in ("hartley", "fusiello")
    error = 3.1e-13 * jitter if exact else 0.4 * jitter
    row = {
        "report": "quick",
        "scene": scene,
        "rig": rig,
        "motion": "as-calibrated",
        "pose": pose,
        "matches": "images" if method in ("hartley", "fusiello") else "",
        "method": method,
        "options": "{}",
        "seed": seed,
        "status": "ok",
        "reason": "",
        "row_error_mean_px": error,
        "row_error_median_px": 0.8 * error,
        "row_error_p95_px": 2.4 * error,
        "row_error_max_px": 5.2 * error,
        "row_error_rms_px": 1.3 * error,
        "row_error_below_1px": 1.0 if exact else 0.93,
        "row_error_source_mean_px": 1.1 * error,
        "row_error_50_mean_px": 0.7 * error,
        "row_error_95_mean_px": 0.9 * error if kept >= 0.95 else float("nan"),
        "row_error_matches": 8123.0,
        "log_distortion": log_distortion * jitter,
        "log_distortion_area": 0.7 * log_distortion * jitter,
        "log_distortion_anisotropy": 0.71 * log_distortion * jitter,
        **view_columns(rig, method, jitter),
        "distortion_native": (native * 40 if rig == "t265" else native) * jitter,
        "distortion_rescaled": 0.6 * native * jitter,
        "distortion_stretched": 0.5 * native * jitter,
        "sampling_lost": 0.4,
        "sampling_invented": 0.31,
        "coverage_pixels": min(1.0, kept * jitter),
        "coverage_solid_angle": min(1.0, kept * (0.9 + 0.1 * jitter)),
        "order_upright": 1.0,
        "fit_s": 0.012 * jitter,
        "maps_s": 0.031,
        "warp_s": 0.0043,
        "notes": NOTES.get(method, "{}"),
    }
    return row | changes


def failed_row(
    scene: str,
    rig: str,
    pose: str,
    method: str,
    status: str = "unsupported",
    reason: str = "an epipole is in view",
) -> dict[str, Any]:
    """The row of a cell that could not be measured: all metrics NaN."""
    row = make_row(scene, rig, pose, method)
    nans = {name: float("nan") for name, value in row.items() if isinstance(value, float)}
    return row | nans | {"status": status, "reason": reason}


def quick_rows(
    scenes: tuple[str, ...] = SCENES,
    rigs: tuple[str, ...] = RIGS,
    poses: tuple[str, ...] = ("exact", "perturbed"),
    methods: tuple[str, ...] = tuple(METHODS),
) -> list[dict[str, Any]]:
    """The rows of a whole run in the bench's order."""
    return [make_row(s, r, p, m) for s, r, p, m in product(scenes, rigs, poses, methods)]


def save_run(
    folder: Path, rows: list[dict[str, Any]], spec: dict[str, Any] | None = None, figures: Any = None
) -> Path:
    """Rows as a run's folder, with a record of a report that has them and what of `spec` is given."""
    record = RunRecord(**FACTS, report=rows[0]["report"], spec=_report(rows, spec or {}, figures))
    write_run(folder, pd.DataFrame(rows), record)
    return folder


def _report(rows: list[dict[str, Any]], spec: dict[str, Any], figures: Any) -> Report:
    def grid(rows: list[dict[str, Any]]) -> dict[str, Any]:
        pairs = dict.fromkeys((row["scene"], row["rig"], row["motion"]) for row in rows)
        return {
            "pairs": tuple(pairs) or (("street", "t265", "as-calibrated"),),
            "methods": tuple(dict.fromkeys([*(row["method"] for row in rows), *METHODS])),
        }

    head = {"name": rows[0]["report"], "title": TITLE, "description": DESCRIPTION, "figures": figures}
    groups = spec.get("groups", ())
    if not groups:
        return Report(**head, **grid(rows), **spec)
    groups = [{**group, **grid([r for r in rows if r["group"] == group["name"]])} for group in groups]
    return Report(**{**head, **spec, "groups": groups})


TITLE = "Five rectifiers on four scenes and three rigs"
DESCRIPTION = "Small images and the fast integrator: a first look, done in a minute and a half."
FACTS: dict[str, Any] = {
    "version": VERSION,
    "report_file": None,
    "command": "rectbench run quick --jobs 2",
    "wall_s": 71.25,
    "git_revision": "0123456789abcdef0123456789abcdef01234567",
    "cpu": "AMD EPYC 7B13",
    "cores": 2,
    "llvm": {"version": "21.1.8"},
    "python": "3.11.2",
    "platform": "Linux",
    "seeds": (0,),
    "selection": Selection(),
    "is_whole": True,
    "jobs": 2,
    "threads_per_job": 1,
    "dask": None,
    "versions": {"rectbench": "0.1.0", "numpy": "2.4.6", "mitsuba": "3.9.1", "opencv": "5.0.0"},
    "data": None,
    "photographs": None,
    "columns": {},
    "cells": (),
}


def fake_rig(width: int = 320, fov_deg: float = 150.0) -> Rig:
    """A fisheye rig with a slightly turned right camera."""
    height = round(width * 0.625)
    focal = width / np.radians(fov_deg)
    camera = Camera(
        "equidistant",
        (width, height),
        {"fx": focal, "fy": focal, "cx": (width - 1) / 2, "cy": (height - 1) / 2},
        max_angle_deg=80,
    )
    angle = np.radians(4.0)
    turn = np.array([[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]])
    return Rig(camera, camera, turn, np.array([-0.4, 0.02, 0.01]), "fake")


def paint(rays: Any) -> Any:
    """Colours [..., 3] uint8 of points of the sphere: a chequered floor, tiles, a sky."""
    azimuth, height = np.arctan2(rays[..., 0], rays[..., 2]), np.arcsin(np.clip(rays[..., 1], -1, 1))
    tiles = (np.floor(azimuth * 9) + np.floor(height * 9)) % 2
    wave = 0.5 + 0.5 * np.sin(40 * azimuth) * np.sin(33 * height)
    grey = np.where(height > 0.2, 90 + 80 * tiles, np.where(height > -0.35, 120 + 60 * wave, 205))
    tint = np.where(height[..., None] > -0.35, np.array([1.0, 0.93, 0.82]), np.array([0.8, 0.9, 1.1]))
    colours = np.where(np.isnan(rays[..., :1]), 0.0, grey[..., None] * tint)
    return np.clip(colours, 0, 255).astype(np.uint8)


def fake_pair(rig: Rig) -> tuple[StereoPair, Truth]:
    """Both cameras stand in a painted sphere about the left one."""
    rays, _ = rig.right.unproject(rig.right.pixel_grid())
    rays_left = rays @ rig.R_right_left
    centre = rig.centre_right_in_left
    along = rays_left @ centre
    reach = -along + np.sqrt(along**2 + SPHERE_M**2 - centre @ centre)
    left_rays, lens = rig.left.unproject(rig.left.pixel_grid())
    points = centre + reach[..., None] * rays_left
    truth = Truth(
        rig,
        depth_left=np.where(lens, SPHERE_M, np.nan).astype(np.float32),
        depth_right=reach.astype(np.float32),
        visible_left=lens & rig.right.sees(rig.right_from_left(SPHERE_M * left_rays)),
        visible_right=rig.left.sees(points),
    )
    return StereoPair(paint(left_rays), paint(points / SPHERE_M)), truth


def fake_rectification(rig: Rig, method: str) -> Rectification:
    """Abraham's for most, as cubics for the one with cubics; a perspective one where images are."""
    focal = float(rig.left.params["fx"])
    w, h = rig.left.size
    if method in ("conventional", "hartley", "fusiello"):
        target: Any = Perspective.from_focal(0.45 * focal, w / 2, h / 2)
        return Rectification.from_targets(rig, target, target, (w, h))
    if method.startswith("local-homography"):
        u, v = (Cubic(side / 2, focal, 0.0, 0.0, -1.5, 1.5) for side in (w, h))
        return Rectification.from_targets(rig, Epipolar(u, v), Epipolar(u, v), (w, h))
    target = Epipolar(Radial("equidistant", focal, w / 2), Radial("equidistant", focal, h / 2))
    return Rectification.from_targets(rig, target, target, (w, h))


@dataclass(frozen=True)
class FakeCloud:
    """What perfect matching would give of every fourth pixel."""

    pair: StereoPair
    truth: Truth

    @property
    def points(self) -> Any:
        return np.where(self.truth.visible_left[..., None], self.truth.points_left, np.nan)[::2, ::2]

    @property
    def colours(self) -> Any:
        return self.pair.left[::2, ::2]


@dataclass(frozen=True)
class FakePair:
    """A pair that is neither rendered nor photographed."""

    images: StereoPair
    rig: Rig
    truth: Truth
    matches: Matches
    knows_truth: bool = True

    def shown_matches(self) -> Matches:
        return self.matches


def fake_sources(width: int = 320) -> Sources:
    """Pictures without a renderer."""
    rig = fake_rig(width)
    images, truth = fake_pair(rig)
    known = FakePair(images, rig, truth, Matches(*truth.matches(2000, seed=0)))
    return Sources(
        pair=lambda result: known,
        rectification=lambda result: fake_rectification(rig, result.method),
        distortion=lambda rect, rig, side, px: distortion(rect, rig, px).per_pixel[side],
        reconstruction=lambda result: FakeCloud(images, truth),
    )
