"""A textured sphere around a rig: its images and its truth in closed form, without a renderer."""

from __future__ import annotations

import numpy as np

import rectbench as rb
from rectbench.matching import Disparity

CENTRE_BASELINES = np.array([1.5, -1.0, 4.0])
RADIUS_BASELINES = 14.0
WAVES = 60


def sphere_truth(rig: rb.Rig) -> rb.Truth:
    """The truth about `rig` in a sphere that holds it: convex, so that nothing hides anything."""
    R, t = rig.R_right_left, rig.t_right_left
    depth_left = distance(rig, rig.left.unproject(rig.left.pixel_grid())[0])
    rays_right = rig.right.unproject(rig.right.pixel_grid())[0] @ R
    depth_right = distance(rig, rays_right, -R.T @ t)
    bare = rb.Truth(rig, depth_left, depth_right, *(np.isfinite(d) for d in (depth_left, depth_right)))
    visible = (np.isfinite(px[..., 0]) for px in (bare.px_right_of_left, bare.px_left_of_right))
    return rb.Truth(rig, depth_left, depth_right, *visible)


def sphere_pair(rig: rb.Rig, seed: int = 0) -> rb.StereoPair:
    """What `rig` sees there: a texture of waves some pixels long, of all directions and three colours."""
    truth, rng = sphere_truth(rig), np.random.default_rng(seed)
    resolution = float(rb.centre_resolution_px(rig))
    lengths_m = RADIUS_BASELINES * rig.baseline_m / resolution * rng.uniform(5, 25, WAVES)
    directions = rng.normal(size=(WAVES, 3))
    k = 2 * np.pi * directions / np.linalg.norm(directions, axis=1, keepdims=True) / lengths_m[:, None]
    phase, amplitude = rng.uniform(0, 2 * np.pi, WAVES), rng.normal(size=(WAVES, 3)) * 90 / np.sqrt(WAVES)

    def image(points: np.ndarray) -> np.ndarray:
        colours = 128 + np.sin(points @ k.T + phase) @ amplitude
        return np.nan_to_num(np.clip(colours, 0, 255)).astype(np.uint8)

    in_left = (truth.points_right - rig.t_right_left) @ rig.R_right_left
    return rb.StereoPair(image(truth.points_left), image(in_left))


def distance(rig: rb.Rig, rays: np.ndarray, origin: np.ndarray | float = 0.0) -> np.ndarray:
    """How far the sphere is along rays [..., 3] of the left camera's frame from `origin`."""
    towards = CENTRE_BASELINES * rig.baseline_m - origin
    along = rays @ towards
    return along + np.sqrt(along**2 - towards @ towards + (RADIUS_BASELINES * rig.baseline_m) ** 2)


def true_disparity(rect: rb.Rectification) -> Disparity:
    """The exact disparity at the pixels of the rectified left image, where both images show the point."""
    rig, (width, height) = rect.rig, rect.size
    pixels = np.stack(np.meshgrid(np.arange(width), np.arange(height)), axis=-1).astype(float)
    rays = rect.left.target.unproject(pixels)[0] @ rect.R_rect_left
    points = rig.right_from_left(rays * distance(rig, rays)[..., None])
    columns = rect.right.target.project(points @ rect.R_rect_right.T)[0][..., 0]
    shown = rect.valid("left") & rig.right.contains(rig.right.project(points)[0])
    shown &= (columns >= -0.5) & (columns <= width - 0.5)
    px = np.where(shown, pixels[..., 0] - columns, np.nan).astype(np.float32)
    return Disparity(rect, px, np.zeros((height, width, 3), np.uint8))
