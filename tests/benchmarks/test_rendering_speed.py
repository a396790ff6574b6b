"""What rendering costs, as ratios within one run and as peak memory.

Run with ``pytest tests/benchmarks/test_rendering_speed.py``.
"""

from __future__ import annotations

import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from pytest_benchmark.fixture import BenchmarkFixture

from rectbench.cameras import Camera
from rectbench.rendering import sensor as sensors
from rectbench.rendering.mitsuba_scene import path_scene
from rectbench.rendering.variant import drjit
from rectbench.rendering.world import Material, Mesh, Sun, World

SIZE = (1280, 800)
ROUNDS = 7
LEAST_THROUGHPUT = 0.9
MOST_MEMORY_GIB = 1.5

PINHOLE = Camera("pinhole", SIZE, {"fx": 640.0, "fy": 640.0, "cx": 639.5, "cy": 399.5})


def yard() -> World:
    """A textured ground full of boards, so that rays have something to do."""
    rng = np.random.default_rng(0)
    material = Material(rng.uniform(0.1, 0.7, (512, 512, 3)).astype(np.float32))
    corners = np.array([[-1, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1]], dtype=float)
    ground = np.array([[-60, -60, 0], [60, -60, 0], [60, 60, 0], [-60, 60, 0]], dtype=float)
    places = rng.uniform([-12, 3, 0], [12, 40, 4], (400, 3))
    vertices = np.concatenate([ground, *(place + 0.6 * corners for place in places)])
    quads = 4 * np.arange(len(vertices) // 4)[:, None]
    faces = np.concatenate([np.add(quads, [0, 1, 2]), np.add(quads, [0, 2, 3])])
    mesh = Mesh("yard", vertices, faces, vertices[:, :2] * 0.3 + vertices[:, 2:] * 0.2, material)
    pose = np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 1.5], [0, 0, 0, 1]], dtype=float)
    return World((mesh,), pose, sun=Sun(), exposure=5.0)


def perspective_sensor(world: World) -> Any:
    """Mitsuba's own sensor with the view of PINHOLE."""
    mi = sensors.register()
    return mi.load_dict(
        {
            "type": "perspective",
            "fov": float(np.degrees(2 * np.arctan(SIZE[0] / 2 / PINHOLE.params["fx"]))),
            "fov_axis": "x",
            "to_world": mi.ScalarTransform4f(world.world_from_left @ sensors.CV_FROM_MITSUBA),
            "film": {
                "type": "hdrfilm",
                "width": SIZE[0],
                "height": SIZE[1],
                "rfilter": {"type": "box"},
                "pixel_format": "rgb",
                "component_format": "float32",
            },
        }
    )


def test_the_sensor_is_as_fast_as_mitsubas_perspective(benchmark: BenchmarkFixture) -> None:
    mi, dr = sensors.register(), drjit()
    world = yard()
    scene = path_scene(world)
    integrator = mi.load_dict({"type": "path", "max_depth": 3})
    contenders = {
        "own": sensors.load_sensor(PINHOLE, world.world_from_left),
        "mitsuba": perspective_sensor(world),
    }

    def render(name: str) -> Any:
        image = mi.render(scene, sensor=contenders[name], integrator=integrator, spp=8, seed=1)
        dr.eval(image)
        dr.sync_thread()
        return image

    images = {name: np.array(render(name)) for name in contenders}  # compiles, and shows that the views agree
    assert np.abs(images["own"] - images["mitsuba"]).mean() < 0.1 * images["mitsuba"].mean()

    seconds = paired({name: lambda name=name: render(name) for name in contenders})
    ratio = statistics.median(m / o for m, o in zip(seconds["mitsuba"], seconds["own"], strict=True))
    benchmark.extra_info["throughput_of_perspective"] = ratio
    benchmark.pedantic(render, args=("own",), rounds=1)
    assert ratio >= LEAST_THROUGHPUT


def paired(contenders: dict[str, Callable[[], Any]]) -> dict[str, list[float]]:
    """Seconds of each contender, round by round, taking turns at going first."""
    seconds: dict[str, list[float]] = {name: [] for name in contenders}
    for turn in range(ROUNDS):
        for name in list(contenders)[:: 1 if turn % 2 else -1]:
            start = time.perf_counter()
            contenders[name]()
            seconds[name].append(time.perf_counter() - start)
    return seconds


MEMORY = """
import resource, sys
sys.path[:0] = {path!r}
from test_rendering_speed import yard
from rectbench.cameras import Camera
from rectbench.rendering.pair import render_pair
from rectbench.rigs.rig import Rig
import numpy as np
lens = dict(fx=980.0, fy=980.0, cx=1367.5, cy=920.5)
camera = Camera("equidistant", (2736, 1842), lens, max_angle_deg=92)
rig = Rig(camera, camera, np.eye(3), np.array([-0.3, 0, 0]))
render_pair(yard(), rig, quality="fast", spp=64)
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20)
"""


def test_a_large_pair_and_its_truth_stay_within_memory(benchmark: BenchmarkFixture) -> None:
    code = MEMORY.format(path=[str(Path(__file__).parent), *sys.path])

    def peak_gib() -> float:
        run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
        return float(run.stdout.split()[-1])

    peak = benchmark.pedantic(peak_gib, rounds=1)
    benchmark.extra_info["peak_gib"] = peak
    assert peak < MOST_MEMORY_GIB
