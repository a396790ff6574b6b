"""Row error of a calibration board's corners, the measure to trust where nobody knows the truth."""

from __future__ import annotations

from rectbench.metrics.row_error import row_error
from rectbench.plugins.metric import Case, Column, Metric, Tolerance


class BoardRowError(Metric):
    """Row error of a calibration board's corners, where both images show one."""

    name, topic = "row_error_board", "Row error"
    needs = frozenset({"images"})
    columns = (
        Column.pixels(
            "row_error_board_mean_px",
            "row error, board",
            "Mean row error of a calibration board's corners, where both images show one: exact to some "
            "hundredths of a pixel, and the measure to trust where nobody knows the truth.",
            tolerance=Tolerance(0.05, 0.01),
            shown="summary",
            without_truth=True,
            panel="of a board's corners",
        ),
        Column.pixels(
            "row_error_board_median_px", "row error, board, median", "Median row error of these corners."
        ),
        Column.pixels("row_error_board_p95_px", "row error, board, p95", "95th percentile of the same."),
        Column.pixels(
            "row_error_board_source_mean_px",
            "row error, board, source",
            "The same mean in pixels of the source images.",
            shown="summary",
            without_truth=True,
        ),
        Column.count(
            "row_error_board_points", "board corners", "Corners of a board that the row error is taken over."
        ),
    )

    def compute(self, case: Case) -> dict[str, float]:
        """Nothing where the images show no board; the board's kind becomes a remark."""
        board = case.pair.board
        if board is None:
            return {}
        case.remarks["board"] = board.kind
        errors = row_error(case.rect, *board.matches).columns()
        errors["row_error_points"] = errors["row_error_matches"]
        found = {column.key: errors.get(column.key.replace("_board", "")) for column in self.columns}
        return {key: value for key, value in found.items() if value is not None}
