"""What Zhou, Dai and Li's paper has, part by part, and what became of it."""

from typing import Literal

import rectbench as rb

_PARTS: tuple[tuple[str, Literal["done", "changed", "impossible"], str], ...] = (
    (
        "Theorems 1 and 2 (II-A, III-B)",
        "changed",
        "Stated there, shown here: the figure under Theorems, and tests that solve for every A, A′ by brute "
        "force. The equation holds up to scale, and of the choice at each pixel only columns are free: rows "
        "are shared.",
    ),
    (
        "Cubics Ψ under Ψ′ > 0, minimising L (III-B to III-D)",
        "changed",
        "Every fit. The parabola Ψ′ is kept positive at its ends and its vertex, not at control points, and "
        "the solver is SLSQP with exact derivatives, not an interior point one.",
    ),
    (
        "Other f(θ) than θ (III-B)",
        "done",
        "The option model of local-homography; under Other models, on every lens.",
    ),
    ("Energy curves (Fig. 4)", "done", "Under Energy, over two coefficients and over each alone."),
    ("Random starts (III-D)", "done", "Under Random starts: ten on every lens."),
    (
        "The backward model as a polynomial (IV-A)",
        "changed",
        "Ψ is inverted exactly; the option inverse=polynomial of local-homography fits one and notes its "
        "error. A cubic is off by up to 18 px on these lenses, degree 9 by up to 0.6 px.",
    ),
    (
        "Robust matching, five-point pose, bundle adjustment (IV, V-A)",
        "changed",
        "SIFT for SURF, which is patented.",
    ),
    (
        "Sony and Canon fisheye pairs (V-A)",
        "changed",
        "The photographs and calibrations are not public: rendered pairs with lenses solved from what the "
        "paper states of them, beside six other fisheye rigs from public calibrations.",
    ),
    (
        "Row error of features found on the rectified images (V-A, Fig. 5a)",
        "changed",
        "Found there too, freed of gross outliers; beside it the row error of the same true matches for all "
        "methods.",
    ),
    (
        "Distortion on the same 500 pixels (V-A, Fig. 5b)",
        "changed",
        "L on these pixels, on ten thousand others that no method knows, and distortion free of scale at "
        "equal view; on sixteen lenses, since it needs no image.",
    ),
    ("Rectified pairs as pictures (Figs. 1, 6, 7)", "done", "Under Pictures."),
    (
        "3-D reconstruction (V-B, Fig. 8)",
        "changed",
        "Semi-global matching for MeshStereo, whose code is not public; scored by the truth at equal view "
        "and over the size of the matched image. The clouds are under Reconstruction.",
    ),
    (
        "SYNTIM perspective pairs (V-C, Figs. 9, 10)",
        "changed",
        "The images' licence does not let them be shipped: four rendered rigs in their manner, without "
        "distortion; two with distortion beside them.",
    ),
    ("Time (V-D)", "changed", "Another machine and language: the shares of pose, fit and warp are judged."),
    (
        "Plane sweeping as the way without rectification (I)",
        "impossible",
        "Named there as related work, not measured. It makes no rectified pair, so that nothing here can "
        "score it.",
    ),
    (
        "Motions with the epipole in the image (VI)",
        "impossible",
        "Left to future work there; local-homography refuses them with a reason.",
    ),
)

PARTS = tuple(rb.SourcePart(name=name, status=status, why=why) for name, status, why in _PARTS)
