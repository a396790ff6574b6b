"""The image planes of two pinholes as pencils of half epipolar lines."""

from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

import rectbench as rb

LINES = 2049
"""Half epipolar lines that are looked at."""
ANY_ROWS = rb.Radial("equidistant", 1.0, 0.0)


@dataclass(frozen=True, eq=False)
class Pencil:
    """The half epipolar lines of the image of a pinhole without distortion."""

    angle_warp: rb.Warp
    plane: rb.Warp = field(init=False)
    """The same of the whole plane, whatever the lens shows of it."""
    polar: rb.PlanarPolar = field(init=False)
    """By lengths, about the corner that is farthest from the epipole; its rows are β."""

    def __post_init__(self) -> None:
        lens, R_rect_cam = self.angle_warp.source, self.angle_warp.R_rect_cam
        plane = replace(self.angle_warp, source=rb.Camera("pinhole", lens.size, dict(lens.params)))
        fx, fy, cx, cy = (lens.params[name] for name in ("fx", "fy", "cx", "cy"))
        matrix = np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1]]) @ R_rect_cam.T
        farthest = np.linalg.norm(matrix[2, 0] * self.corners - matrix[:2, 0], axis=1).argmax()
        u, v = map(float, self.corners[farthest])
        object.__setattr__(self, "plane", plane)
        object.__setattr__(self, "polar", rb.PlanarPolar(matrix, (u, v), ANY_ROWS))

    @property
    def corners(self) -> np.ndarray:
        """[4, 2], where the image ends, pixels; the first and the last are opposite."""
        right, bottom = np.array(self.angle_warp.source.size) - 0.5
        return np.array([[-0.5, -0.5], [right, -0.5], [-0.5, bottom], [right, bottom]])

    def lines(self, beta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Half lines at β [K]: their pixels at û = 0 and unit directions [K, 2], against which û rises."""
        _, (start_u, start_v, along_u, along_v) = self.polar.axis_tables(np.zeros(1), beta)
        starts = np.stack([start_u, start_v], axis=-1) + self.polar.reference
        return starts, np.stack([along_u, along_v], axis=-1)

    def far_ends(self, beta: np.ndarray) -> np.ndarray:
        """Pixels [K, 2] where the lines leave the image away from the epipole; NaN of those that miss it."""
        starts, along = self.lines(beta)
        with np.errstate(divide="ignore", invalid="ignore"):
            at_edges = (starts[:, None] - self.corners[[0, 3]]) / along[:, None]  # û, each way
        enters, leaves = at_edges.min(axis=1).max(axis=-1), at_edges.max(axis=1).min(axis=-1)
        far = np.where(self.polar.matrix[2, 0] > 0, enters, leaves)
        far[~(enters < leaves)] = np.nan
        return starts - far[:, None] * along

    def px_per_rad(self, pixels: np.ndarray) -> np.ndarray:
        """How far apart lines are at pixels [K, 2], a radian of β; 0 where there is no pixel."""
        (_, across) = np.moveaxis(self.plane.jacobian(pixels), -2, 0)
        return np.nan_to_num(1 / np.linalg.norm(across, axis=-1))

    def columns(self, polar: rb.PlanarPolar) -> tuple[float, float]:
        """The least and the greatest û that the lens shows, from a pixel beside its epipole on."""
        lens = self.angle_warp.source
        pixels, spacing_px = rb.outline_pixels(lens)
        u, v, w = polar.matrix[:, 0]
        with np.errstate(divide="ignore", invalid="ignore"):
            about_epipole = np.array([u, v]) / w + [[-1, 0], [1, 0], [0, -1], [0, 1]]
        pixels = np.concatenate([pixels, about_epipole[lens.contains(about_epipole)]])
        reached = replace(self.angle_warp, target=polar).forward(pixels)[:, 0]
        return float(np.nanmin(reached) - spacing_px), float(np.nanmax(reached) + spacing_px)


@dataclass(frozen=True, eq=False)
class EpipolarPlanes:
    """Both images of a pair of such pinholes."""

    rig: rb.Rig
    pencils: tuple[Pencil, Pencil]

    @classmethod
    def of(cls, problem: rb.Problem) -> "EpipolarPlanes | None":
        """Those of a problem; None where a lens is no pinhole, or one with distortion."""
        if not (is_ideal(problem.rig.left) and is_ideal(problem.rig.right)):
            return None
        left, right = problem.angle_warps()
        return cls(problem.rig, (Pencil(left), Pencil(right)))

    def beta(self) -> np.ndarray:
        """β [K] of lines: evenly, and through the images' corners, where far ends turn from edge to edge."""
        even = np.linspace(*rb.view_angles(self.rig).beta, LINES)
        corners = np.concatenate([pencil.plane.forward(pencil.corners)[:, 1] for pencil in self.pencils])
        return np.unique(np.concatenate([even, corners[(corners > even[0]) & (corners < even[-1])]]))

    def at_far_ends(self, beta: np.ndarray) -> np.ndarray:
        """Pixels between lines, a radian of β, at the far ends of those at β [K]: [2, K], left and right."""
        return np.stack([pencil.px_per_rad(pencil.far_ends(beta)) for pencil in self.pencils])

    def on_arcs(self, beta: np.ndarray) -> np.ndarray:
        """The same on the arc about each epipole through its farthest corner."""
        return np.stack([pencil.px_per_rad(pencil.lines(beta)[0]) for pencil in self.pencils])

    def rectification(self, along: Literal["length", "logarithm"], rows: rb.Profile) -> rb.Rectification:
        """Columns along the lines, in a frame that just holds both images."""
        first, last = float(rows(rows.low)), float(rows(rows.high))
        left, right = (replace(p.polar, along=along, v=rows.framed(first, 1.0)) for p in self.pencils)
        right = replace(right, start_px=self.apart_px(left, right))
        reached = [pencil.columns(polar) for pencil, polar in zip(self.pencils, (left, right), strict=True)]
        least, greatest = np.min(reached), np.max(reached)
        targets: list[rb.Target] = [
            replace(polar, start_px=polar.start_px - float(least) - 0.5) for polar in (left, right)
        ]
        if rows.high - rows.low >= 2 * np.pi:
            targets = [rb.Wrapped(target, -0.5, last - first) for target in targets]
        size = int(np.ceil(greatest - least)), int(np.ceil(last - first))
        return rb.Rectification.from_targets(self.rig, targets[0], targets[1], size)

    def apart_px(self, left: rb.PlanarPolar, right: rb.PlanarPolar) -> float:
        """How much greater û is in the left image than in the right, of what both see far away: the median.

        Lengths in two images have no common zero. Where they see nothing in common, of their middles.
        """
        warps = [
            replace(pencil.angle_warp, target=polar)
            for pencil, polar in zip(self.pencils, (left, right), strict=True)
        ]
        pixels = rb.evaluation_pixels(self.rig.left)
        rays = self.rig.left.unproject(pixels)[0] @ self.rig.R_right_left.T
        both = self.rig.right.sees(rays)
        if not both.any():
            ranges = [
                pencil.columns(polar) for pencil, polar in zip(self.pencils, (left, right), strict=True)
            ]
            return float(np.mean(ranges[0]) - np.mean(ranges[1]))
        columns = warps[1].forward(self.rig.right.project(rays[both])[0])[:, 0]
        return float(np.nanmedian(warps[0].forward(pixels[both])[:, 0] - columns))


def is_ideal(camera: rb.Camera) -> bool:
    """Whether it is a pinhole without distortion, so that its image is a plane."""
    return camera.model == "pinhole" and not any(
        value for name, value in camera.params.items() if name not in ("fx", "fy", "cx", "cy")
    )
