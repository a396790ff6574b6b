"""The small worlds and rigs that the rendering tests share."""

from __future__ import annotations

import numpy as np
import pytest
from small_worlds import facing_wall, fisheye, quad, world_of

from rectbench.rendering.world import Material, Sun, World
from rectbench.rigs.rig import Rig


@pytest.fixture(scope="session")
def checks() -> Material:
    """Random bright and dark squares."""
    squares = np.random.default_rng(7).uniform(0.05, 0.6, (16, 16, 3)).astype(np.float32)
    return Material(np.kron(squares, np.ones((4, 4, 1), dtype=np.float32)))


@pytest.fixture(scope="session")
def rig() -> Rig:
    """Two unlike fisheyes, turned against each other."""
    angle = 0.05
    R = np.array([[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]])
    return Rig(fisheye(), fisheye(112, 80), R, np.array([-0.3, 0.02, 0.04]), name="unlike")


@pytest.fixture(scope="session")
def yard(checks: Material) -> World:
    """A textured ground and a wall with a pane, under the sun."""
    ground = quad("ground", [[-50, -50, 0], [50, -50, 0], [50, 50, 0], [-50, 50, 0]], checks, repeats=40.0)
    pane = Material((0.05, 0.05, 0.06), glossy=True)
    return world_of(
        ground, facing_wall(6.0, 2.5, checks), facing_wall(4.0, 0.5, pane, x=2.0), sun=Sun(), exposure=5.0
    )
