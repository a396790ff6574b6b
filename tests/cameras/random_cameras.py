"""Random cameras of every projection model, and the rays that fill the domain of one."""

import math
from collections.abc import Callable
from functools import partial

import numpy as np
from hypothesis import strategies as st

from rectbench.cameras import Camera

SIZE = (1280, 960)
MODELS = (
    "pinhole",
    "kannala-brandt",
    "unified",
    "extended-unified",
    "double-sphere",
    "field-of-view",
    "ocam",
    "equidistant",
    "equisolid",
    "stereographic",
    "orthographic",
    "thin-prism-fisheye",
    "fisheye624",
    "cahvor",
    "division",
    "f-theta",
    "tilted-pinhole",
    "radial-tangential",
)


def within(low: float, high: float, *special: float) -> st.SearchStrategy[float]:
    """Numbers of the interval, the special ones often among them."""
    numbers = st.floats(low, high)
    return st.one_of(st.sampled_from(special), numbers, numbers) if special else numbers


FOCAL = {"fx": within(150, 900), "fy": within(150, 900), "cx": within(300, 900), "cy": within(200, 700)}
PARAMETERS = {
    "pinhole": FOCAL
    | {name: within(-0.3, 0.3, 0) for name in ("k1", "k2", "k4", "k5")}
    | {name: within(-0.1, 0.1, 0) for name in ("k3", "k6")}
    | {name: within(-0.01, 0.01, 0) for name in ("p1", "p2", "s1", "s2", "s3", "s4")},
    "kannala-brandt": FOCAL
    | {"k1": within(-0.1, 0.1, 0), "k2": within(-0.05, 0.05, 0)}
    | {"k3": within(-0.03, 0.03, 0), "k4": within(-0.01, 0.01, 0), "skew": within(-20, 20, 0)},
    "unified": FOCAL
    | {"xi": within(-0.5, 3, 0, 1, 1 + 1e-9), "skew": within(-20, 20, 0)}
    | {name: within(-0.3, 0.3, 0) for name in ("k1", "k2")}
    | {name: within(-0.01, 0.01, 0) for name in ("p1", "p2")},
    "extended-unified": FOCAL | {"alpha": within(0, 1, 0, 0.5, 1), "beta": within(0.3, 3)},
    "double-sphere": FOCAL | {"xi": within(-0.95, 0.99, 0), "alpha": within(0, 1, 0, 0.5, 1)},
    "field-of-view": FOCAL | {"omega": within(0, 3, 0, 1e-5, 1e-3)},
    "equidistant": FOCAL,
    "equisolid": FOCAL,
    "stereographic": FOCAL,
    "orthographic": FOCAL,
    "thin-prism-fisheye": FOCAL
    | {"k1": within(-0.1, 0.1, 0), "k2": within(-0.05, 0.05, 0)}
    | {"k3": within(-0.03, 0.03, 0), "k4": within(-0.01, 0.01, 0)}
    | {name: within(-0.01, 0.01, 0) for name in ("p1", "p2", "sx1", "sy1")},
    "fisheye624": FOCAL
    | {"k0": within(-0.1, 0.1, 0), "k1": within(-0.05, 0.05, 0), "k2": within(-0.03, 0.03, 0)}
    | {name: within(-0.01, 0.01, 0) for name in ("k3", "k4", "k5", "p0", "p1", "s0", "s1", "s2", "s3")},
    "cahvor": FOCAL
    | {name: within(-0.05, 0.05, 0) for name in ("alpha", "beta")}
    | {"r0": within(-0.3, 0.3, 0), "r1": within(-0.3, 0.3, 0), "r2": within(-0.1, 0.1, 0)},
    "division": FOCAL | {"k": within(-0.6, 0.3, 0, -1e-9, -0.25)},
}

PARAMETERS["tilted-pinhole"] = PARAMETERS["pinhole"] | {n: within(-0.2, 0.2, 0) for n in ("tau_x", "tau_y")}
PARAMETERS["radial-tangential"] = (
    FOCAL
    | {"k1": within(-0.3, 0.3, 0), "k2": within(-0.2, 0.2, 0), "skew": within(-20, 20, 0)}
    | {"k3": within(-0.1, 0.1, 0), "k4": within(-0.05, 0.05, 0)}
    | {name: within(-0.01, 0.01, 0) for name in ("p1", "p2")}
)


@st.composite
def _ocam(draw: Callable[[st.SearchStrategy[float]], float]) -> Camera:
    focal = draw(within(150, 600))
    depth = np.array(
        [
            focal,
            0.0,
            draw(within(-1.0, 0.3)) / focal,
            draw(within(-0.3, 0.3)) / focal**2,
            draw(within(-0.5, 0.5)) / focal**3,
        ]
    )
    affine = {"c": draw(within(0.95, 1.05)), "d": draw(within(-0.01, 0.01)), "e": draw(within(-0.01, 0.01))}
    sign = draw(st.sampled_from([-1.0, 1.0]))
    return Camera("ocam", SIZE, {"cx": 630.0, "cy": 470.0, **affine, "poly": tuple(sign * depth)})


@st.composite
def _f_theta(draw: Callable[[st.SearchStrategy[float]], float]) -> Camera:
    focal = draw(within(150, 600))
    poly = [
        scale / focal**power
        for power, scale in enumerate(
            (1.0, *(draw(within(-bound, bound, 0)) for bound in (0.1, 0.1, 0.05, 0.02))), 1
        )
    ]
    affine = {"c": draw(within(0.95, 1.05)), "d": draw(within(-0.01, 0.01)), "e": draw(within(-0.01, 0.01))}
    return Camera("f-theta", SIZE, {"cx": 630.0, "cy": 470.0, **affine, "angle_poly": poly})


def cameras(model: str) -> st.SearchStrategy[Camera]:
    """Cameras of one model over the whole range of its parameters."""
    if model in ("ocam", "f-theta"):
        return _ocam() if model == "ocam" else _f_theta()
    return st.fixed_dictionaries(PARAMETERS[model]).map(partial(Camera, model, SIZE))


def any_camera() -> st.SearchStrategy[Camera]:
    """Cameras of any model."""
    return st.sampled_from(MODELS).flatmap(cameras)


def ray(theta: np.ndarray, phi: np.ndarray) -> np.ndarray:
    """Unit rays [..., 3] at the angle theta from the axis, in the direction phi about it, radians."""
    theta, phi = np.broadcast_arrays(theta, phi)
    return np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1)


def edge_angle(camera: Camera, phi: np.ndarray) -> np.ndarray:
    """The greatest angle from the axis that the camera sees in each direction, by bisection."""
    low, high = np.zeros_like(phi), np.full_like(phi, math.pi)
    for _ in range(52):
        middle = 0.5 * (low + high)
        _, ok = camera.project(ray(middle, phi))
        low, high = np.where(ok, middle, low), np.where(ok, high, middle)
    return low


def domain_rays(camera: Camera, per_direction: int = 40, directions: int = 24) -> np.ndarray:
    """Unit rays [N, 3] all over the domain: even ones, and ever nearer to the axis and to the edge."""
    phi = np.random.default_rng(7).uniform(0, 2 * math.pi, directions)
    edge = edge_angle(camera, phi)
    near = np.concatenate([[0.0], np.geomspace(1e-15, 1e-2, 12)])
    share = np.concatenate([near, np.linspace(0.02, 0.98, per_direction), 1 - near])
    return ray(share[:, None] * edge, phi).reshape(-1, 3)


def angle_between(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Angles [...] between unit rays [..., 3], radians, exact for small ones."""
    return 2 * np.arcsin(np.minimum(np.linalg.norm(a - b, axis=-1) / 2, 1.0))
