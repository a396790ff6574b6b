"""Which method serves which lens under which motion, epipoles in the view or not?"""

import rectbench as rb

report = rb.Report(
    name="motions",
    title="Any lens, any motion",
    description=(
        "Four ideal equidistant lenses of 100°, 160°, 190° and 220°, and how the right camera may stand to "
        "the left: beside it, above it, before it, behind it, aslant, or looking another way by 30°, 60° or "
        "90°. Where an epipole is in the view, rows meet there, and the view is trimmed about it, for all "
        "methods alike; what is kept is counted against the whole lens. Nothing is rendered: row errors are "
        "of points at 5 to 200 baselines, under the exact pose and under a perturbed one (0.05° off in "
        "rotation, 0.3° in the baseline's direction). Hartley and Fusiello work from true matches with 0.1 "
        "px of noise."
    ),
    rigs=("lens-100", "lens-160", "lens-190", "lens-220"),
    motions=(
        "sideways",
        "vertical",
        "diagonal",
        "forward",
        "backward",
        "apart-30",
        "apart-60",
        "apart-90",
    ),
    methods=(
        "conventional",
        "hartley",
        "fusiello",
        "abraham",
        "local-homography",
        "polar",
        "log-polar",
        "polar-optimal",
    ),
    poses=("exact", "perturbed"),
    matches=("true + 0.1 px",),
    metrics=("geometry", "row_error"),
    figures=("motions", "coverage-curve"),
    image_width=640,
)
