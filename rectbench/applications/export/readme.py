"""The README of an exported dataset: its conventions, with its own numbers, and how each file is read.

The Python in it runs as it stands from the dataset's folder (the tests do so).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

Pairs = Sequence[Mapping[str, Any]]

CONVENTIONS = """\
## Conventions

- **Pixels.** Pixel (0, 0) is the centre of the top-left pixel, as in OpenCV; u goes right, v down. COLMAP's
  coordinates are larger by 0.5.
- **Cameras** look along +z, x right, y down. `X_right = R_right_left @ X_left + t_right_left`, metres.
- **Depth** is the distance from the camera's centre along the pixel's own ray, metres; a point is the unit
  ray times it. It is not z: on a wide lens z tends to 0 towards 90° whatever the distance.
- **Truth** is that of the pixel's centre, one ray cast through it. Images average over the pixel.
- **Rows** of the rectified pair agree. **Disparity** is u_left - u_right at a pixel of the rectified left
  image, of the surface its own ray hits: nothing is resampled. It is there too where something hides the
  point from the right camera; `matched` and `disparity_noc` leave those pixels out.
- **Nothing there** is the sky, or where a lens or a rectified image shows nothing.
"""

READING = """\
## Reading

```python
import json
import cv2
import numpy as np

index = json.load(open("dataset.json"))
name = index["pairs"][0]["name"]

# images: 8 bits, sRGB; OpenCV gives BGR
left = cv2.imread(f"left/{name}.png")
rectified = cv2.imread(f"rectified/left/{name}.png")

# depth: float32, metres along the ray, NaN where nothing is; or whole millimetres, 0 where nothing is
depth = cv2.imread(f"depth_left/{name}.pfm", cv2.IMREAD_UNCHANGED)
millimetres = cv2.imread(f"depth_mm_left/{name}.png", cv2.IMREAD_UNCHANGED)

# disparity: float32, pixels, infinity where nothing is; or KITTI's 16 bits, 0 where nothing is
disparity = cv2.imread(f"disparity/{name}.pfm", cv2.IMREAD_UNCHANGED)
kitti = cv2.imread(f"disparity_occ/{name}.png", cv2.IMREAD_UNCHANGED) / 256

# masks: 255 where it holds
visible = cv2.imread(f"visible_left/{name}.png", cv2.IMREAD_UNCHANGED) > 0
matched = cv2.imread(f"matched/{name}.png", cv2.IMREAD_UNCHANGED) > 0

# flow: float32 (du, dv) from a left pixel to its right one, 1e10 where nothing is
flow = np.fromfile(f"flow/{name}.flo", np.float32, offset=12).reshape(*left.shape[:2], 2)
flow[flow > 1e9] = np.nan
```
"""

READING_EXR = """
The `.exr` files hold the same float32 numbers as the `.pfm` ones beside them, in one channel Y; OpenCV's own
packages are built without OpenEXR, the package `OpenEXR` reads them:

```python
import OpenEXR

depth_exr = OpenEXR.File(f"depth_left/{name}.exr").channels()["Y"].pixels
```
"""

READING_RIG = """
Calibrations are the true ones, of the rendering cameras, without noise.{circle}

```python
storage = cv2.FileStorage(f"calibration/{name}/opencv.yml", cv2.FILE_STORAGE_READ)
K1, D1, R, T = (storage.getNode(key).mat() for key in ("K1", "D1", "R", "T"))
model = storage.getNode("model_1").string()  # pinhole: cv2, fisheye: cv2.fisheye, omnidir: cv2.omnidir
```
"""

READING_POINTS = """
With rectbench, a point of the rectified pair:

```python
import rectbench as rb

rig = rb.load_rig(f"calibration/{name}/rig.yaml")
rect = rb.load_rectification(f"rectified/description/{name}/rectified.yaml")
point_left = rect.triangulate([100.0, 50.0], disparity[50, 100])  # metres, in the left camera's frame
```
"""

FILES = """\
| folder | format | what |
|---|---|---|
| left, right | PNG | the rendered images, sRGB |
| depth_left, depth_right | EXR, PFM | distance along the ray, metres; NaN where nothing is |
| depth_mm_left, depth_mm_right | PNG, 16 bits | the same, millimetres; 0 where nothing is or over 65.535 m |
{z_depth}| visible_left, visible_right | PNG | 255 where the other camera sees the pixel's point too |
| flow | .flo | from a left pixel to where its point lies in the right image; 1e10 where off that image |
| rectified/left, rectified/right | PNG | the images rectified, bilinear; black where nothing is |
| rectified/mask_left, rectified/mask_right | PNG | 255 where these show nothing but their source |
| disparity | PFM | of the rectified left image, pixels; infinity where nothing is, as in Middlebury |
| disparity_occ | PNG, 16 bits | the same times 256, as KITTI; 0 where nothing is or outside (0, 256) px |
| disparity_noc | PNG, 16 bits | of these, where `matched` holds |
| matched | PNG | 255 where the right camera sees the point, and the rectified right image holds it |
| rectified/description | YAML | the rectification; OpenCV's R1 R2 P1 P2 Q where it has them |
| calibration | YAML | the true rig: {calibrations} |
| pairs | JSON | a pair's numbers, and the SHA-256 of its files |
"""
Z_DEPTH = "| {sides} | EXR, PFM | z of the point in its camera's frame, metres; NaN where nothing is |\n"
NO_Z_DEPTH = "\nNo depth along z is there: the lenses look 80° or more off their axes.\n"


def readme_text(settings: Mapping[str, Any], pairs: Pairs) -> str:
    """The README of a dataset of at least one pair, in Markdown."""
    calibrations = _calibrations(pairs)
    parts = [_title(settings), _numbers(pairs), CONVENTIONS, _files(pairs, calibrations), READING]
    parts.append(READING_EXR)
    if "opencv.yml" in calibrations:
        parts.append(READING_RIG.replace("{circle}", _image_circle(settings["rig"])))
    return "\n".join([*parts, READING_POINTS]).replace("\n\n\n", "\n\n")


def _title(settings: Mapping[str, Any]) -> str:
    scene, rig = settings["scene"], settings["rig"]
    width = f", {settings['image_width']} px wide" if settings["image_width"] else ""
    options = ", ".join(f"{name} = {value}" for name, value in settings["options"].items())
    return (
        f"# {scene}, seen by {rig['name']}\n\n"
        f"Rendered by rectbench {settings['versions']['rectbench']}: scene `{scene}`, rig `{rig['name']}` "
        f"({rig['left']['model']} and {rig['right']['model']}){width}, motion `{settings['motion']}`, "
        f"{settings['spp']} samples a pixel ({settings['quality']}).\n"
        f"Rectified by `{settings['method']}`{f' ({options})' if options else ''} from the true rig.\n"
        "`dataset.json` has these settings, and the numbers and files of each pair; "
        "a file's name is the pair's seed.\n"
    )


def _numbers(pairs: Pairs) -> str:
    seeds = ", ".join(str(pair["seed"]) for pair in pairs)
    sides = "; ".join(f"{side} {_sizes(pairs, f'{side}_size')}" for side in ("left", "right", "rectified"))
    shares = [100 * pair["matched_share"] for pair in pairs]
    rows = max(pair["row_difference_px"] for pair in pairs)
    return (
        "## Numbers\n\n"
        f"- {len(pairs)} pair{'s' if len(pairs) > 1 else ''}, seed{'s' if len(pairs) > 1 else ''} {seeds}\n"
        f"- sizes: {sides} px\n"
        f"- baseline {_span([pair['baseline_m'] for pair in pairs], 'm')}; "
        f"left depth {_span(_ends(pairs, 'depth_m'), 'm')}\n"
        f"- disparity {_span(_ends(pairs, 'disparity_px'), 'px')}; "
        f"both cameras see the point at {_span(shares, '%')} of the rectified left pixels\n"
        f"- rows of matching points differ by at most {rows:.1g} px\n"
        f"- {sum(pair['outside_kitti'] for pair in pairs)} disparities have no place in KITTI's 16 bits"
        " (0 and less occurs where each image has columns of its own)\n"
    )


def _files(pairs: Pairs, calibrations: Sequence[str]) -> str:
    kinds = {path.rpartition("/")[0] for pair in pairs for path in pair["files"]}
    sides = ", ".join(kind for kind in ("z_left", "z_right") if kind in kinds)
    z_depth = Z_DEPTH.format(sides=sides) if sides else ""
    table = FILES.format(z_depth=z_depth, calibrations=", ".join(calibrations))
    return f"## Files\n\n{table}{'' if sides else NO_Z_DEPTH}"


def _calibrations(pairs: Pairs) -> list[str]:
    paths = [path for pair in pairs for path in pair["files"] if path.startswith("calibration/")]
    return list(dict.fromkeys(path.rpartition("/")[2] for path in sorted(paths)))


def _image_circle(rig: Mapping[str, Any]) -> str:
    """A word on what only rig.yaml says."""
    ends = [rig[side]["max_angle_deg"] for side in ("left", "right")]
    if not any(ends):
        return ""
    left, right = (f"{end:g}°" if end else "no bound" for end in ends)
    return f" Only\n`rig.yaml` says where the image circles end: {left} off the axis left, {right} right."


def _sizes(pairs: Pairs, key: str) -> str:
    found = sorted({tuple(pair[key]) for pair in pairs})
    texts = [f"{width}x{height}" for width, height in found]
    return texts[0] if len(texts) == 1 else f"{texts[0]} to {texts[-1]}"


def _ends(pairs: Pairs, key: str) -> list[float]:
    return [value for pair in pairs for value in pair[key] or ()]


def _span(values: Sequence[float], unit: str) -> str:
    """The least and the greatest value, as one where they are alike."""
    if not values:
        return "none"
    low, high = f"{min(values):.4g}", f"{max(values):.4g}"
    return f"{low} {unit}" if low == high else f"{low} to {high} {unit}"
