"""Every rectifier of the field on every lens, under three motions: who comes nearest to the floor?"""

import rectbench as rb

HOMOGRAPHIES = (
    *("conventional", "fusiello-trucco-verri", "lafiosca-ceccaroni", "three-step", "opencv-stereo-rectify"),
    *("hartley", "loop-zhang", "gluckman-nayar", "fusiello", "usr-cgd", "dsr", "opencv-uncalibrated"),
    "s2p-affine",
)
SCAN_LINES = ("optimal", "polar-optimal", "local-homography", "polar", "log-polar", "abraham")
WIDE = (
    *("mrcal-latlon", "mrcal-pinhole", "opencv-fisheye", "opencv-omnidir", "psph", "spherical"),
    *("cylinder", "multi-pinhole", "equirectangular", "stereographic-circles"),
)
METHODS = (*SCAN_LINES, *WIDE, *HOMOGRAPHIES)
OPTIONS = {
    "opencv-omnidir": [{"mode": mode} for mode in ("longlati", "perspective", "cylindrical", "stereographic")]
}

report = rb.Report(
    name="field",
    title="The field: every rectifier on every lens",
    description=(
        "Every method that ships with rectbench on every rig that does, at 640 pixels of width. Distortion "
        "and row error need no image: they are measured on lenses alone, under the pose as calibrated, a "
        "sideways motion, and on four ideal lenses under motions that show the epipoles; the perturbed pose "
        "is 0.05° off in rotation and 0.3° in the baseline's direction. Methods that work from matches get "
        "true ones with 0.1 px of noise. Homographies take perspective images; on a fisheye lens they are "
        "given an undistorted view, and what that leaves out they do not keep. Four pairs are rendered, for "
        "features and for dense matching."
    ),
    groups=(
        rb.Group(
            name="census",
            title="All lenses",
            rigs=rb.rig_names(),
            motions=("as-calibrated", "sideways"),
            methods=METHODS,
            options=OPTIONS,
            matches=("true + 0.1 px",),
            metrics=("geometry", "row_error"),
            figures=("survey",),
        ),
        rb.Group(
            name="motions",
            title="Other motions",
            rigs=("lens-100", "lens-160", "lens-190", "lens-220"),
            motions=("vertical", "diagonal", "forward", "apart-60"),
            poses=("exact",),
            methods=METHODS,
            options=OPTIONS,
            matches=("true + 0.1 px",),
            metrics=("geometry",),
            figures=("motions",),
        ),
        rb.Group(
            name="pairs",
            title="Rendered pairs",
            pairs=(
                ("street", "sony-as200v", "sideways"),
                ("corridor", "t265", "sideways"),
                ("room", "pinhole-toed-in", "as-calibrated"),
                ("forest", "pinhole-shifted", "as-calibrated"),
            ),
            methods=METHODS,
            options=OPTIONS,
            poses=("estimated",),
            metrics=("geometry", "row_error", "row_error_features", "reconstruction", "timing"),
            figures=("bars",),
        ),
    ),
    poses=("exact", "perturbed"),
    image_width=640,
    quality="fast",
    spp=8,
)
