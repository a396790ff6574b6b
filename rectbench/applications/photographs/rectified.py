"""What was made of photographs: the frame and its costs, how each pair fared, the numbers as files."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from rectbench.applications.choose_method import Choice
from rectbench.applications.rectification_files import Files
from rectbench.errors import InvalidInput, PoseNotFound
from rectbench.matching.boards.corners import board_matches
from rectbench.matching.pose.consistent import consistent_matches
from rectbench.metrics import RowError, row_error
from rectbench.metrics.coverage import TRIMMED, trimmed_text
from rectbench.pairs.finding.image_circle import ImageCircle
from rectbench.pairs.finding.names import FilePair, LeftOut
from rectbench.rigs import Rig
from rectbench.types import Images, Matches
from rectbench.warps import Rectification

ELSEWHERE_PX = 5.0
"""Rows farther off than this, source pixels, are no matter of a calibration's accuracy."""


@dataclass(frozen=True, eq=False)
class PairResult:
    """How one pair fared."""

    pair: FilePair
    reason: str = ""
    """Why it was left out; empty where it was rectified."""
    features: RowError | None = None
    """Row errors of feature matches that agree with one another."""
    board: RowError | None = None
    """Row errors of the corners of a calibration board, the measure to trust."""
    note: str = ""
    """The kind of board, or why nothing could be measured."""

    @property
    def columns(self) -> dict[str, Any]:
        """The row of this pair in `pairs.csv`."""
        pair, status = self.pair, "left out" if self.reason else "ok"
        about = {"pair": pair.name, "left": str(pair.left), "right": str(pair.right), "status": status}
        rows = _row_columns("features", self.features) | _row_columns("board", self.board)
        return about | {"reason": self.reason, "note": self.note} | rows


@dataclass(frozen=True, eq=False)
class OwnMatches:
    """Correspondences that a pair's own images tell, without any calibrated pose."""

    features: Matches | None = None
    board: Matches | None = None
    """Of the corners of a calibration board."""
    note: str = ""

    @staticmethod
    def of(images: Images, rig: Rig, seed: int) -> OwnMatches:
        found = board_matches(*images)
        board, note = (found.matches, found.kind) if found else (None, "")
        try:
            return OwnMatches(consistent_matches(rig.left, rig.right, images, seed=seed), board, note)
        except (PoseNotFound, InvalidInput) as reason:
            return OwnMatches(None, board, note or str(reason))

    @property
    def best(self) -> Matches | None:
        """The board's, where there is one."""
        return self.board or self.features

    def measured(self, pair: FilePair, rect: Rectification) -> PairResult:
        """The pair with the row errors of these correspondences."""
        features, board = (m and row_error(rect, *m) for m in (self.features, self.board))
        return PairResult(pair, features=features, board=board, note=self.note)


@dataclass(frozen=True, eq=False)
class RectifiedImages:
    """What was made of the photographs of a rig, or of the rig alone."""

    method: str
    rectification: Rectification
    costs: Mapping[str, float]
    """Of the frame, see `frame_costs`."""
    own_costs: Mapping[str, float] | None
    """Of the frame that the method makes by itself; None where that is the frame."""
    choice: Choice | None
    """How the method was chosen, where it was."""
    unpaired: tuple[LeftOut, ...] = ()
    """Images without a partner."""
    circle: ImageCircle | None = None
    """What the lenses were held to, where a mask or the images themselves show it."""
    pairs: tuple[PairResult, ...] = ()
    files: tuple[Path, ...] = ()

    @property
    def left_out(self) -> tuple[str, ...]:
        """Why pairs and images were left out, one line each."""
        reasons = [result.reason for result in self.pairs if result.reason]
        return (*reasons, *(f"{image.path}: {image.reason}" for image in self.unpaired))

    @property
    def rows(self) -> dict[str, float]:
        """Row errors over all measured pairs: `row_error_board_*` and `row_error_features_*`."""
        rows: dict[str, float] = {}
        for kind in ("board", "features"):
            found = [error for result in self.pairs if (error := getattr(result, kind)) is not None]
            if any(np.isfinite(error.rectified_px).any() for error in found):
                every = ((error.rectified_px, error.source_px) for error in found)
                rows |= _row_columns(kind, RowError(*map(np.concatenate, zip(*every, strict=True))))
        return rows

    @property
    def remarks(self) -> tuple[str, ...]:
        """What was trimmed of the view, and that disparities are negative, where either is so."""
        rig, trimmed = self.rectification.rig, self.costs.get(TRIMMED)
        told = []
        if trimmed and rig.margin_deg is not None:
            told.append(trimmed_text(trimmed, rig.margin_deg))
        if rig.is_right_first:
            told.append(
                "disparities are negative: by the calibration the right camera stands to the other's left"
            )
        return tuple(told)

    @property
    def warning(self) -> str:
        """That images and calibration do not belong together, where the rows say so; else nothing."""
        known = [self.rows.get(f"row_error_{kind}_source_median_px") for kind in ("board", "features")]
        off = next((error for error in known if error is not None), 0.0)  # a board's word goes first
        if off <= ELSEWHERE_PX:
            return ""
        return (
            f"rows are {off:.0f} source pixels off in the median: these images are not of this "
            "calibration, or left and right are swapped"
        )


def summary_files(made: RectifiedImages) -> Files:
    """`metrics.json`, and of several pairs `pairs.csv`."""
    metrics: dict[str, Any] = {"method": made.method, "frame": dict(made.costs)}
    if made.circle:
        metrics["image_circle"] = {"max_angle_deg": made.circle.angle_deg, "why": made.circle.told}
    if made.own_costs:
        metrics["frame_of_the_method"] = dict(made.own_costs)
    if made.choice:
        metrics["choice"] = {"why": made.choice.why, "methods": made.choice.table.to_dict("records")}
    metrics |= {"rows": made.rows, "pairs": [result.columns for result in made.pairs]}
    metrics |= {"left_out": list(made.left_out), "remarks": list(made.remarks)}
    files = {"metrics.json": (json.dumps(_finite(metrics), indent=1, ensure_ascii=False) + "\n").encode()}
    if len(made.pairs) > 1:
        files["pairs.csv"] = pd.DataFrame([r.columns for r in made.pairs]).to_csv(index=False).encode()
    return files


def _finite(value: Any) -> Any:
    """The same with null for numbers that JSON has not."""
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_finite(item) for item in value]
    return None if isinstance(value, float) and not np.isfinite(value) else value


def _row_columns(kind: str, error: RowError | None) -> dict[str, float]:
    if error is None:
        return {}
    return {name.replace("row_error", f"row_error_{kind}"): value for name, value in error.columns().items()}
