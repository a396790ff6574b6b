"""Asks Debian's mrcal, which lives in the system's own Python, for a rectified system; see test_mrcal.py.

Reads a JSON object from standard input and writes one to standard output: that is all two Pythons share.
"""

import json
import sys

import mrcal
import numpy as np


def main() -> None:
    asked = json.load(sys.stdin)
    models = [
        mrcal.cameramodel(
            intrinsics=(asked["lens"], np.array(intrinsics)),
            imagersize=asked["size"],
            extrinsics_Rt_fromref=np.array(Rt),
        )
        for intrinsics, Rt in zip(asked["intrinsics"], asked["Rt_cam_left"], strict=True)
    ]
    fov = {"az_fov_deg": asked["az_fov_deg"], "el_fov_deg": asked["el_fov_deg"]}
    kind = {"rectification_model": asked["rectification"]}
    scale = -asked["pixels_per_deg"]
    rectified = mrcal.rectified_system(
        models, **fov, **kind, pixels_per_deg_az=scale, pixels_per_deg_el=scale
    )
    if asked["rectification"] == "LENSMODEL_LATLON":
        # Later versions than Debian 12's make the field of view a whole number of pixels: so shall this one.
        width, height = rectified[0].imagersize()
        rectified = mrcal.rectified_system(
            models,
            **fov,
            **kind,
            pixels_per_deg_az=width / fov["az_fov_deg"],
            pixels_per_deg_el=height / fov["el_fov_deg"],
        )
    every = asked["every"]
    maps = mrcal.rectification_maps(models, rectified)
    json.dump(
        {
            "size": [int(side) for side in rectified[0].imagersize()],
            "maps": [np.asarray(one, dtype=float)[::every, ::every].tolist() for one in maps],
        },
        sys.stdout,
    )


main()
