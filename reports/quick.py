"""All fisheye lenses without a scene, and four scenes on three of them: where does each method stand?"""

import rectbench as rb

METHODS = ("conventional", "abraham", "hartley", "fusiello", "local-homography")

report = rb.Report(
    name="quick",
    title="Five rectifiers on fisheye lenses, and on four scenes",
    description=(
        "A quick look at 640 pixels of width. Distortion needs no scene: it is measured on every fisheye rig "
        "that ships with rectbench (lenses of 120° and more across the diagonal), under two motions each, "
        "with the pose known exactly. Row errors are those of four scenes rendered with fast shading in "
        "three of these rigs: under the exact pose every calibrated method has none; under the perturbed "
        "pose (0.05° off in rotation, 0.3° in the baseline's direction) each shows how it carries the error. "
        "Hartley and Fusiello work from SIFT matches of the images, and on lenses without a scene from true "
        "ones with 0.1 px of noise."
    ),
    groups=(
        rb.Group(
            name="lenses",
            title="All fisheye lenses",
            rigs=rb.fisheye_rigs(),
            # Without a scene a wide baseline is a sideways one; toed in by 6°, a lens of 170° sees its own
            # epipole, which no method serves.
            motions=("as-calibrated", "sideways"),
            poses=("exact",),
            methods=METHODS,
            matches=("true + 0.1 px",),
            metrics=("geometry",),
            figures=("coverage-curve", "critical-difference"),
        ),
        rb.Group(
            name="pairs",
            title="Rendered pairs",
            scenes=("street", "corridor", "room", "forest"),
            rigs=("sony-as200v", "t265", "canon-8mm"),
            motions=("sideways",),
            methods=METHODS,
            metrics=("geometry", "row_error", "row_error_features", "timing"),
        ),
    ),
    poses=("exact", "perturbed"),
    image_width=640,
    quality="fast",
    spp=8,
)
