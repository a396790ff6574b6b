"""Photographs and calibrations of one's own: `rectbench run real --data FOLDER`."""

import rectbench as rb

report = rb.Report(
    name="real",
    title="Rectifiers on photographs",
    description=(
        "The pairs and calibrations found in a folder, each under its pose as calibrated and as the images "
        "themselves tell it. Nobody knows the truth about photographs. The row error of a calibration "
        "board's corners is the measure to trust, where both images show one. That of SIFT matches holds the "
        "detector's own noise, some tenths of a pixel; these are the matches that agree with one another on "
        "a pose, whatever the calibration says, so that a wrong calibration shows. Hartley and Fusiello work "
        "from matches of the same images under either pose."
    ),
    photographs=True,
    poses=("calibrated", "estimated"),
    methods=("conventional", "abraham", "hartley", "fusiello", "local-homography"),
    metrics=("geometry", "row_error_features", "row_error_board", "timing"),
    figures=("bars", "coverage-curve", "pairs", "maps", "clouds"),
)
