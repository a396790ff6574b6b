"""An estimated pose."""

from __future__ import annotations

from rich.table import Table
from rich.text import Text

from rectbench.cli.printing.screen import console
from rectbench.matching import PoseEstimate
from rectbench.rigs import Rig


def show_pose(estimate: PoseEstimate, rig: Rig) -> None:
    """An estimated pose, how sure it is, and how far the calibration's own is from it."""
    screen, table = console(), Table(box=None, pad_edge=False, show_header=False)
    rotation_deg, direction_deg = estimate.difference_deg(rig)
    (a, b, c), (x, y, z) = estimate.rotation_vector_deg, estimate.direction_right_left
    found, seconds = len(estimate.inliers.left), estimate.seconds
    for name, value, remark in (
        ("rotation", f"({a:+.3f}, {b:+.3f}, {c:+.3f})°", f"± {estimate.rotation_sigma_deg:.3f}°"),
        ("direction", f"({x:+.4f}, {y:+.4f}, {z:+.4f})", f"± {estimate.direction_sigma_deg:.3f}°"),
        ("motion", estimate.motion, ""),
        ("matches", f"{found} of {estimate.given} fit", f"noise {estimate.noise_px:.2f} px a coordinate"),
        ("calibration", f"rotation {rotation_deg:.3f}° off", f"direction {direction_deg:.3f}° off"),
        (
            "time",
            f"{sum(seconds.values()):.2f} s",
            ", ".join(f"{stage} {took:.2f}" for stage, took in seconds.items()),
        ),
    ):
        table.add_row(name, value, remark)
    screen.print(table)
    if estimate.note:
        screen.print(Text(f"warning: {estimate.note}", style="yellow"), soft_wrap=True)
