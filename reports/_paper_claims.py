"""What Zhou, Dai and Li claim, each as statements that a run can refute."""

from collections.abc import Mapping
from typing import Any

import rectbench as rb

FISHEYE = ("conventional", "abraham", "local-homography")
PERSPECTIVE = ("hartley", "fusiello", "local-homography")
OURS = "local-homography"
STATED_FOCAL = {"focal": "min-distortion"}
"""The paper's conventional method has the focal length of least distortion."""
OPTIONS: Mapping[str, Mapping[str, str]] = {"conventional": STATED_FOCAL}

L_WAYS = {
    "L, own scale, on the 500 pixels that are fitted": "distortion_native_grid",
    "L, own scale": "distortion_native",
    "L, best single scale": "distortion_rescaled",
    "L, best scales of width and height": "distortion_stretched",
}
EQUAL_VIEW = {
    f"log distortion, {share} % of the view": f"log_distortion_{share}" for share in (50, 75, 95, 100)
}
"""Free of scale, on the same source pixels for all methods."""
DISTORTIONS = {**L_WAYS, **EQUAL_VIEW}
"""The ways to compare resampling distortion, by what they are called in the table of claims."""
ON_HALF_THE_VIEW = {**L_WAYS, **dict(list(EQUAL_VIEW.items())[:1])}
"""What homographies in an image of the source's size keep on every pair."""

IN_RECTIFIED_PX = {
    "SIFT on the rectified images": "row_error_rectified_features_mean_px",
    "SIFT on the source images, 50 % of the view": "row_error_features_50_mean_px",
    "true matches, 50 % of the view": "row_error_50_mean_px",
}
"""As the paper measures it, and on the same matches for all methods."""
IN_SOURCE_PX = {
    "SIFT on the rectified images, source px": "row_error_rectified_features_source_mean_px",
    "true matches, 50 % of the view, source px": "row_error_source_50_mean_px",
}
ROW_ERRORS = {**IN_RECTIFIED_PX, **IN_SOURCE_PX}
"""The ways to measure row error."""
AT_95 = {
    "true matches, 95 % of the view": "row_error_95_mean_px",
    "true matches, 95 % of the view, source px": "row_error_source_95_mean_px",
}
"""Of methods that keep so much; homographies in an image of the source's size do not."""

SIZES = {"0.25 MP": "0_25mp", "0.5 MP": "0_5mp", "1 MP": "1mp"}
"""How large the matched image is: pixels of it that show the source."""

DRAMATICALLY = 0.5
"""At most half of it counts as "dramatically" less."""
ABOUT_30_PERCENT_LESS = {"above": 0.6, "below": 0.8}
VERY_CLOSE = {"above": 0.9, "below": 1.1}


def in_each_way(
    what: str, clause: str, columns: Mapping[str, str], where: str = "", **stated: Any
) -> list[rb.Statement]:
    """The same statement under each way to measure."""
    return [
        rb.Statement(label=f"{what}, {words}{where}", clause=clause, metric=metric, **stated)
        for words, metric in columns.items()
    ]


def against(
    clause: str,
    group: str,
    rivals: tuple[str, ...],
    columns: Mapping[str, str],
    where: str = "",
    **stated: Any,
) -> list[rb.Statement]:
    """The ratio of our value to each rival's."""
    ours = {"group": group, "method": OURS, "measure": "ratio", **stated}
    return [
        statement
        for rival in rivals
        for statement in in_each_way(
            f"{OURS} / {rival}",
            f"{clause} {rival}",
            columns,
            where,
            against=rival,
            against_options=OPTIONS.get(rival, {}),
            **ours,
        )
    ]


def values(
    clause: str, group: str, methods: tuple[str, ...], columns: Mapping[str, str], **stated: Any
) -> list[rb.Statement]:
    """The value of each method."""
    return [
        statement
        for method in methods
        for statement in in_each_way(
            method,
            f"{method} {clause}",
            columns,
            group=group,
            method=method,
            options=OPTIONS.get(method, {}),
            **stated,
        )
    ]


def least_on(
    clause: str, group: str, method: str, rivals: tuple[str, ...], columns: Mapping[str, str], above: int
) -> list[rb.Statement]:
    """That the method has the least value on so many of four."""
    return in_each_way(
        f"rigs on which {method} is least",
        clause,
        columns,
        group=group,
        method=method,
        rivals=tuple(rival for rival in rivals if rival != method),
        measure="count",
        above=above,
        of=4,
    )


ROW_ERROR = rb.Claim(
    name="Row error, fisheye",
    says="The row error is below 1 pixel for every method; Abraham's is the smallest, the paper's very "
    "close.",
    statements=[
        *values("below 1 px", "fisheye", FISHEYE, IN_RECTIFIED_PX, below=1.0),
        *least_on("the smallest", "fisheye", "abraham", FISHEYE, ROW_ERRORS, above=3),
        *against("very close to", "fisheye", ("abraham",), {**ROW_ERRORS, **AT_95}, **VERY_CLOSE),
    ],
    because={
        "held": "All methods share one pose and its error; in rectified pixels they differ by the scale of "
        "their images.",
        "depends": "All methods share one pose and its error. In rectified pixels the smallest is who makes "
        "the smallest image; in source pixels, on the same matches, they are alike.",
        "not held": "All methods share one pose and its error. In rectified pixels the smallest is who "
        "makes the smallest image; in source pixels, on the same matches, they are alike.",
        "not measured": "No pair could be measured.",
    },
)

DISTORTION = rb.Claim(
    name="Distortion, fisheye",
    says="The paper's method has the least distortion on all four fisheye pairs, dramatically below "
    "the conventional one, and about 30 % below Abraham's.",
    statements=[
        *least_on("the least", "lenses", OURS, FISHEYE, DISTORTIONS, above=4),
        *against("dramatically below", "lenses", ("conventional",), DISTORTIONS, below=DRAMATICALLY),
        *against("about 30 % below", "lenses", ("abraham",), DISTORTIONS, **ABOUT_30_PERCENT_LESS),
    ],
    because={
        "held": "Its cubics are fitted to this measure.",
        "depends": "L is what its cubics minimise. How far below Abraham's it is depends on the scale of "
        "Abraham's image, which the paper leaves open, and on the lens; free of scale and on the same part "
        "of the view it is another order.",
        "not held": "L is what its cubics minimise. How far below Abraham's it is depends on the scale of "
        "Abraham's image, which the paper leaves open, and on the lens; free of scale and on the same part "
        "of the view it is another order.",
        "not measured": "No lens could be measured.",
    },
)

PERSPECTIVE_PAIRS = rb.Claim(
    name="Perspective pairs",
    says="On four perspective pairs the row error is below 1 pixel for every method and the paper's the "
    "best on three; its distortion is dramatically below Hartley's and Fusiello's.",
    statements=[
        *values("below 1 px", "perspective", PERSPECTIVE, IN_RECTIFIED_PX, below=1.0),
        *least_on("best on three", "perspective", OURS, PERSPECTIVE, ROW_ERRORS, above=3),
        *against("dramatically below", "perspective", PERSPECTIVE[:2], ON_HALF_THE_VIEW, below=DRAMATICALLY),
        *against(
            "dramatically below",
            "distorted",
            PERSPECTIVE[:2],
            ON_HALF_THE_VIEW,
            where=", lenses with distortion",
            judges=False,
            below=DRAMATICALLY,
        ),
    ],
    because={
        "held": "Bent columns and rows follow the image better than a homography can, even without a lens's "
        "distortion.",
        "depends": "The row errors of all methods come from the same matches of the images; in rectified "
        "pixels the scale of an image decides, too.",
        "not held": "The row errors of all methods come from the same matches of the images; none is best "
        "by nature. Without a lens's distortion a homography bends little, and the margin is smaller than "
        "on lenses with it.",
        "not measured": "No pair could be measured.",
    },
)

STARTS = rb.Claim(
    name="Insensitive to its start",
    says="The minimisation is not sensitive to its start, even a random one; the energy is nearly convex "
    "over a large range.",
    statements=[
        rb.Statement(
            label="share of random starts that end at the same L",
            clause="any start",
            group="starts",
            metric="distortion_native_grid",
            method=OURS,
            against=OURS,
            against_group="lenses",
            measure="share",
            within=(0.0, 1.01),
            above=0.95,
        ),
        rb.Statement(
            label="share of three slices of the energy, ±50 %, where it is convex",
            clause="nearly convex",
            group="lenses",
            metric="energy_convex_share",
            method=OURS,
            above=0.95,
        ),
    ],
    because={
        "held": "The losses are smooth in a few slopes, which stay positive where rows keep their order: "
        "one basin holds all the starts that were tried.",
        "depends": "Most starts find the same minimum, but a descent can also end at an image shrunk to "
        "nothing, where L is 1 and flat.",
        "not held": "A descent can also end at an image shrunk to nothing, where L is 1 and flat, and on "
        "wide lenses L is not convex far from its minimum.",
        "not measured": "No lens could be measured.",
    },
)

RECONSTRUCTION = rb.Claim(
    name="Denser reconstruction",
    says="3-D reconstruction through the paper's rectification is denser than through the perspective one.",
    statements=[
        rb.Statement(
            label=f"{method} / conventional, {what}, {view} % of the view, {size}",
            clause=what,
            group="fisheye",
            metric=f"reconstruction_{what}_{view}_at_{key}",
            method=method,
            against="conventional",
            against_options=STATED_FOCAL,
            measure="ratio",
            above=1.0,
            judges=method == OURS,
        )
        for what in ("density", "completeness")
        for view in (50, 75, 95)
        for size, key in SIZES.items()
        for method in (OURS, "abraham")
    ],
    because={
        "held": "At one size of the matched image a perspective image spends its pixels on its rim: what is "
        "left for the middle is small.",
        "depends": "It depends on what is asked for and on how large the matched image is: a perspective "
        "image spends its pixels on its rim, which costs the middle its accuracy before its density.",
        "not held": "At the focal length that the paper states, and at equal view and size, the perspective "
        "image is matched as densely. It spends its pixels on its rim, though: in a small matched image "
        "less of what is found is right, and Abraham's map mends that as well.",
        "not measured": "No pair could be measured.",
    },
)

TIME = rb.Claim(
    name="Time",
    says="A pair of 1920x1280 pixels takes 15 s: 6 for the pose, 3 for the fit, 6 for the warp.",
    statements=[
        *(
            rb.Statement(
                label=f"{words}, share of the total",
                clause=f"{words}'s part",
                group="timing",
                metric=metric,
                over="total_s",
                method=OURS,
                above=share - 0.1,
                below=share + 0.1,
            )
            for words, metric, share in (
                ("pose", "pose_s", 0.4),
                ("fit", "fit_s", 0.2),
                ("warp", "warp_s", 0.4),
            )
        ),
        *(
            rb.Statement(
                label=f"{words} [s], on this machine",
                clause="seconds",
                group="timing",
                metric=metric,
                method=OURS,
                below=seconds,
                judges=False,
            )
            for words, metric, seconds in (
                ("pose", "pose_s", 6.0),
                ("fit", "fit_s", 3.0),
                ("warp", "warp_s", 6.0),
                ("all of it", "total_s", 15.0),
            )
        ),
    ],
    because={
        "held": "Seconds of another machine in another language can be neither held nor refuted here; the "
        "parts stand to each other as they did.",
        "depends": "Seconds of another machine in another language can be neither held nor refuted here. Of "
        "the parts, some keep their share: exact gradients shorten the fit, compiled tables the warp.",
        "not held": "Seconds of another machine in another language can be neither held nor refuted here. "
        "The parts stand otherwise to each other: exact gradients shorten the fit, compiled tables the "
        "warp, and what is left is the pose.",
        "not measured": "No pair could be measured.",
    },
)

VIEW = rb.Claim(
    name="Field of view",
    says="The rectified image keeps nearly the whole field of view.",
    statements=[
        rb.Statement(
            label=f"{method}: share of the view in an image of the source's size, at its centre resolution",
            clause="nearly the whole",
            group="lenses",
            metric="view_at_source_size",
            method=method,
            options=OPTIONS.get(method, {}),
            above=0.95,
            judges=method == OURS,
        )
        for method in (OURS, "abraham", "conventional")
    ],
    because={
        "held": "A frame can be made to hold any view; at the source's own size and resolution, too, little "
        "is pushed out of it.",
        "not held": "A frame can be made to hold any view. At the source's own size and resolution some of "
        "it is pushed out, though far less than by a perspective image.",
        "not measured": "No lens could be measured.",
    },
)

CLAIMS = (ROW_ERROR, DISTORTION, PERSPECTIVE_PAIRS, STARTS, RECONSTRUCTION, TIME, VIEW)
