"""Correspondences that a pair's own images tell, without any calibrated pose."""

from __future__ import annotations

from dataclasses import dataclass

from rectbench.applications.photographs.rectified import PairResult
from rectbench.errors import InvalidInput, PoseNotFound
from rectbench.matching.boards.corners import board_matches
from rectbench.matching.pose.consistent import consistent_matches
from rectbench.metrics import row_error
from rectbench.pairs.finding.names import FilePair
from rectbench.rigs import Rig
from rectbench.types import Images, Matches
from rectbench.warps import Rectification


@dataclass(frozen=True, eq=False)
class OwnMatches:
    """Of features, and of the corners of a calibration board."""

    features: Matches | None = None
    board: Matches | None = None
    note: str = ""

    @staticmethod
    def of(images: Images, rig: Rig, seed: int) -> OwnMatches:
        found = board_matches(*images)
        board, note = (found.matches, found.kind) if found else (None, "")
        try:
            features = consistent_matches(rig.left, rig.right, images, seed=seed)
        except (PoseNotFound, InvalidInput) as reason:
            return OwnMatches(None, board, note or str(reason))
        return OwnMatches(features, board, note)

    @property
    def best(self) -> Matches | None:
        """The board's, where there is one."""
        return self.board or self.features

    def measured(self, pair: FilePair, rect: Rectification) -> PairResult:
        """The pair with the row errors of these correspondences."""
        features, board = (m and row_error(rect, *m) for m in (self.features, self.board))
        return PairResult(pair, features=features, board=board, note=self.note)
