"""What does each freedom of a rectification gain, and what do scan lines cost at all?"""

import rectbench as rb

FREE = tuple(
    {"objective": objective, "columns": columns, "intervals": intervals, "search": "quick"}
    for objective in ("log", "L")
    for columns in ("separable", "full")
    for intervals in (1, 2, 4, 8, 16)
)
UNSHARED = tuple(
    {"objective": objective, "rows": "per-image", "intervals": 8, "search": "quick"}
    for objective in ("log", "L")
)

report = rb.Report(
    name="floor",
    title="The floor under all maps to scan lines",
    description=(
        "Free columns and rows of least log distortion, or of least L, by how much of them is free: columns "
        "h(γ), all lines alike, or h(β, γ), each line as is best for it; splines of 1 to 16 intervals, and "
        "four times as many in the rows; rows shared by both images, or each image with its own, which "
        "rectifies nothing and tells what sharing costs. Beside them Abraham's lens laws, with one number an "
        "axis, and the paper's cubics, with three. Nothing is rendered; all of the view counts."
    ),
    rigs=("sony-as200v", "t265", "canon-8mm", "tumvi", "kitti-360", "lens-160"),
    motions=("as-calibrated",),
    methods=("abraham", "local-homography", "optimal"),
    options={"optimal": (*FREE, *UNSHARED)},
    poses=("exact",),
    metrics=("log_distortion", "distortion"),
    figures=("freedom",),
    image_width=640,
)
