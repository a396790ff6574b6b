"""Four scenes on three fisheye rigs, small and fast: does all work, and where does each method stand?"""

import rectbench as rb

report = rb.Report(
    name="quick",
    title="Five rectifiers on four scenes and three fisheye rigs",
    description=(
        "A quick look at 640 pixels of width with fast shading. Under the exact pose every calibrated "
        "method has no row error, and distortion tells them apart; under the perturbed pose (0.05° off "
        "in rotation, 0.3° in the baseline's direction) each shows how it carries the error."
    ),
    scenes=("street", "corridor", "room", "forest"),
    rigs=("sony-as200v", "t265", "canon-8mm"),
    motions=("sideways",),
    poses=("exact", "perturbed"),
    methods=("conventional", "abraham", "hartley", "fusiello", "local-homography"),
    image_width=640,
    quality="fast",
    spp=8,
    metrics=("geometry", "row_error", "row_error_features", "timing"),
    match_noise_px=0.1,
)
