"""A dataset holds the truth, in files that OpenCV and NumPy read, and goes on where it was cut off."""

from __future__ import annotations

import json
import re
from importlib.util import find_spec
from pathlib import Path

import cv2
import numpy as np
import pytest

import rectbench as rb
from rectbench.applications.export import file_formats as encode
from rectbench.errors import InvalidInput, UnknownName
from rectbench.rendering.pair import Stage
from rectbench.warps.description import load_rectification
from tests.conftest import Shell

SCENE = '''
"""A wall and, before it, a panel."""

import numpy as np

import rectbench as rb

WALL_M, PANEL_M, PANEL = 2.0, 1.0, (-0.25, 0.2, -0.3, 0.15)


def smooth(seed):
    noise = np.random.default_rng(seed).uniform(0.1, 0.9, (12, 12, 3))
    return rb.Material(np.kron(noise, np.ones((40, 40, 1))).astype(np.float32))


def quad(name, depth, left, right, bottom, top, material, repeats):
    corners = [[left, depth, bottom], [right, depth, bottom], [right, depth, top], [left, depth, top]]
    uv = repeats * np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
    return rb.Mesh(name, np.array(corners, dtype=float), np.array([[0, 1, 2], [0, 2, 3]]), uv, material)


@rb.scene("panel")
def build(seed: int) -> rb.World:
    """A wall two metres away, and half as far a panel."""
    pose = np.eye(4)
    pose[:3, :3] = np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]])
    wall = quad("wall", WALL_M, -6, 6, -6, 6, smooth(seed), 2.0)
    panel = quad("panel", PANEL_M, *PANEL, smooth(seed + 1), 0.2)
    return rb.World((wall, panel), pose, ambient=(1.0, 1.0, 1.0))
'''
WALL_M, PANEL_M, PANEL = 2.0, 1.0, (-0.25, 0.2, -0.3, 0.15)
SMALL = {"spp": 64, "quality": "fast", "image_width": 160}
NAMES = ("000000", "000004")
SIDES = ("left", "right")


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("scene") / "panel.py"
    path.write_text(SCENE)
    return path


@pytest.fixture(scope="module")
def rig() -> rb.Rig:
    return rb.load_rig("t265").within(75)


@pytest.fixture(scope="module")
def dataset(scene: Path, rig: rb.Rig, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two pairs of a rig whose right camera stands another way in each."""
    out = tmp_path_factory.mktemp("dataset")
    made = rb.export_dataset(scene, rig, out, motion="sideways", seeds=(0, 4), **SMALL)
    assert (made.rendered, made.kept) == ((0, 4), ())
    return out


def read(path: Path) -> np.ndarray:
    content = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
    assert content is not None, path
    return content


def files_of(folder: Path) -> dict[str, bytes]:
    return {str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


def right_centre(folder: Path, name: str) -> np.ndarray:
    return rb.load_rig(folder / f"calibration/{name}/rig.yaml").centre_right_in_left


@pytest.mark.parametrize("name", NAMES)
def test_disparities_triangulate_to_the_surfaces_that_are_there(dataset: Path, name: str) -> None:
    """In the left camera's frame (x right, y down) all points lie on the wall or on the panel."""
    rect = load_rectification(dataset / f"rectified/description/{name}/rectified.yaml")
    disparity = read(dataset / f"disparity/{name}.pfm").astype(float)
    v, u = np.nonzero(np.isfinite(disparity))
    assert len(u) > 0.5 * disparity.size
    points = rect.triangulate(np.stack([u, v], axis=-1), disparity[v, u])
    on_panel = points[:, 2] < 1.5
    # A float32 disparity of some 5 px is good to 2e-7 of it, and the triangle is that much off.
    np.testing.assert_allclose(points[:, 2], np.where(on_panel, PANEL_M, WALL_M), rtol=2e-5)
    left, right, bottom, top = PANEL
    x, y, _ = points[on_panel].T
    assert (x > left - 1e-4).all()
    assert (x < right + 1e-4).all()
    assert (-y > bottom - 1e-4).all()
    assert (-y < top + 1e-4).all()
    assert on_panel.sum() > 200


@pytest.mark.parametrize("name", NAMES)
def test_what_the_panel_hides_from_the_right_camera_is_not_matched(dataset: Path, name: str) -> None:
    rect = load_rectification(dataset / f"rectified/description/{name}/rectified.yaml")
    disparity = read(dataset / f"disparity/{name}.pfm").astype(float)
    disparity[~np.isfinite(disparity)] = np.nan
    matched = read(dataset / f"matched/{name}.png") > 0
    v, u = np.indices(disparity.shape)
    points = rect.triangulate(np.stack([u, v], axis=-1), disparity)
    eye = right_centre(dataset, name)
    share = (PANEL_M - eye[2]) / (points[..., 2] - eye[2])
    x, y, _ = np.moveaxis(eye + share[..., None] * (points - eye), -1, 0)
    left, right, bottom, top = PANEL
    inside = np.minimum.reduce([x - left, right - x, -y - bottom, top + y])
    hidden = (points[..., 2] > 1.5) & (inside > 1e-3)
    clear = (points[..., 2] > 1.5) & (inside < -1e-3)
    assert hidden.sum() > 20
    assert not matched[hidden].any()
    px, seen = rect.rig.right.project(rect.rig.right_from_left(points[clear]))
    u_right = (u - disparity)[clear]
    there = seen & rect.rig.right.contains(px) & (u_right >= 0) & (u_right <= rect.size[0] - 1)
    assert matched[clear][there].all()
    assert not matched[clear][~seen].any()


@pytest.mark.parametrize("name", NAMES)
def test_the_right_image_moved_by_the_disparity_is_the_left_one(dataset: Path, name: str) -> None:
    left, right = (read(dataset / f"rectified/{side}/{name}.png").astype(np.float32) for side in SIDES)
    disparity = np.nan_to_num(read(dataset / f"disparity/{name}.pfm"), posinf=0)
    matched = (read(dataset / f"matched/{name}.png") > 0) & (
        read(dataset / f"rectified/mask_left/{name}.png") > 0
    )
    v, u = np.indices(disparity.shape, dtype=np.float32)

    def difference(shift: np.ndarray) -> float:
        moved = cv2.remap(right, u - shift, v, cv2.INTER_LINEAR)
        return float(np.abs(moved - left).mean(axis=-1)[matched].mean())

    assert difference(disparity) < 4.0  # of 255: what two bilinear samples of hard edges differ by
    assert difference(disparity) < 0.5 * difference(np.zeros_like(disparity))
    for off in (-0.5, 0.5):
        assert 1.5 * difference(disparity) < difference(disparity + np.float32(off))


def test_every_form_of_a_disparity_says_the_same(dataset: Path) -> None:
    for name in NAMES:
        exact = read(dataset / f"disparity/{name}.pfm")
        everywhere = read(dataset / f"disparity_occ/{name}.png")
        visible = read(dataset / f"disparity_noc/{name}.png")
        matched = read(dataset / f"matched/{name}.png") > 0
        written = np.isfinite(exact) & (exact >= 1 / 511)
        np.testing.assert_allclose(everywhere[written] / 256, exact[written], atol=1 / 511)
        assert (everywhere[~np.isfinite(exact) | (exact < 1 / 513)] == 0).all()
        np.testing.assert_array_equal(visible, np.where(matched, everywhere, 0))


def test_images_depth_flow_and_masks_are_those_of_render(dataset: Path, scene: Path, rig: rb.Rig) -> None:
    images, truth = rb.render(scene, rig, "sideways", seed=4, **SMALL)
    for side in SIDES:
        np.testing.assert_array_equal(read(dataset / f"{side}/000004.png")[..., ::-1], getattr(images, side))
        depth = getattr(truth, f"depth_{side}")
        np.testing.assert_array_equal(read(dataset / f"depth_{side}/000004.pfm"), depth)
        np.testing.assert_array_equal(
            read(dataset / f"visible_{side}/000004.png") > 0, getattr(truth, f"visible_{side}")
        )
        millimetres = read(dataset / f"depth_mm_{side}/000004.png")
        assert millimetres.dtype == np.uint16
        np.testing.assert_allclose(millimetres, np.nan_to_num(1000 * depth), atol=0.5001)
        z = read(dataset / f"z_{side}/000004.pfm")
        np.testing.assert_allclose(z, getattr(truth, f"points_{side}")[..., 2], rtol=1e-6)
    flow = cv2.readOpticalFlow(str(dataset / "flow/000004.flo"))
    expected = truth.px_right_of_left - truth.rig.left.pixel_grid()
    known = np.isfinite(expected).all(axis=-1)
    assert known.mean() > 0.5
    np.testing.assert_allclose(flow[known], expected[known], rtol=1e-6, atol=1e-5)
    assert (flow[~known] > 1e9).all()


def test_calibrations_are_the_rendered_rig_s(dataset: Path) -> None:
    folder = dataset / "calibration/000004"
    rig = rb.load_rig(folder / "rig.yaml")
    assert rig.left.max_angle_deg == 75
    for file in ("kalibr.yaml", "opencv.yml"):
        other = rb.load_rig(folder / file)
        assert dict(other.left.params) == dict(rig.left.params)
        np.testing.assert_allclose(other.t_right_left, rig.t_right_left, atol=1e-15)


def test_an_exr_holds_what_the_pfm_holds(dataset: Path) -> None:
    from rectbench.rendering.variant import mitsuba

    exr = np.array(mitsuba().Bitmap(str(dataset / "depth_left/000000.exr")))
    assert exr.dtype == np.float32
    np.testing.assert_array_equal(exr.squeeze(), read(dataset / "depth_left/000000.pfm"))


def test_the_readme_s_python_runs_and_its_numbers_are_true(
    dataset: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    readme = (dataset / "README.md").read_text()
    monkeypatch.chdir(dataset)
    has_openexr = find_spec("OpenEXR") is not None
    blocks = re.findall(r"```python\n(.*?)```", readme, re.DOTALL)
    assert len(blocks) == 4
    scope: dict[str, object] = {}
    for block in blocks:
        if has_openexr or "OpenEXR" not in block:
            exec(block, scope)
    point, disparity = scope["point_left"], scope["disparity"]
    assert point[2] == pytest.approx(WALL_M, rel=1e-4) or point[2] == pytest.approx(PANEL_M, rel=1e-4)
    height, width = disparity.shape
    assert f"{width}x{height}" in re.search(r"^- sizes:.*$", readme, re.MULTILINE)[0]
    index = json.loads((dataset / "dataset.json").read_text())
    assert [pair["name"] for pair in index["pairs"]] == list(NAMES)
    assert max(pair["row_difference_px"] for pair in index["pairs"]) < 1e-10
    folders = re.findall(r"^\| ([a-z_/, ]+) \|", readme, re.MULTILINE)[1:]
    for folder in ", ".join(folders).split(", "):
        assert (dataset / folder).is_dir(), folder
    told = {path for pair in index["pairs"] for path in pair["files"]}
    there = {path for path in files_of(dataset) if not path.startswith("pairs/")}
    assert there == told | {"README.md", "dataset.json"}


def test_an_export_that_was_cut_off_goes_on_to_the_same_bytes(
    dataset: Path, scene: Path, rig: rb.Rig, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    original, taken = Stage.photograph, []

    def interrupted(stage: Stage, *args: object, **kwargs: object) -> rb.StereoPair:
        taken.append(stage)
        if len(taken) == 2:
            raise KeyboardInterrupt
        return original(stage, *args, **kwargs)

    monkeypatch.setattr(Stage, "photograph", interrupted)
    with pytest.raises(KeyboardInterrupt):
        rb.export_dataset(scene, rig, tmp_path, motion="sideways", seeds=(0, 4), **SMALL)
    assert not (tmp_path / "dataset.json").exists()
    made = rb.export_dataset(scene, rig, tmp_path, motion="sideways", seeds=(0, 4), **SMALL)
    assert (made.rendered, made.kept) == ((4,), (0,))
    assert files_of(tmp_path) == files_of(dataset)


def test_a_pair_with_a_damaged_file_is_made_again(scene: Path, rig: rb.Rig, tmp_path: Path) -> None:
    tiny = {**SMALL, "image_width": 64, "spp": 1}
    rb.export_dataset(scene, rig, tmp_path, **tiny)
    before = files_of(tmp_path)
    (tmp_path / "left/000000.png").write_bytes(b"cut short")
    assert rb.export_dataset(scene, rig, tmp_path, **tiny).rendered == (0,)
    assert files_of(tmp_path) == before
    assert rb.export_dataset(scene, rig, tmp_path, **tiny).kept == (0,)


def refuse_to_render(*args: object, **kwargs: object) -> None:
    raise AssertionError("something was rendered")


@pytest.mark.parametrize(
    ("changed", "error", "message"),
    [
        ({"spp": 16}, InvalidInput, "holds pair 000000 of other settings"),
        ({"method": "conventional"}, InvalidInput, "holds pair 000000 of other settings"),
        ({"seeds": ()}, InvalidInput, "seeds is empty"),
        ({"seeds": (-1,)}, InvalidInput, "seed is -1"),
        ({"motion": "sidewards"}, UnknownName, "unknown motion 'sidewards'; did you mean sideways"),
        ({"method": "hartley"}, InvalidInput, "hartley works from matches"),
        ({"image_width": 0}, InvalidInput, "image_width is 0"),
    ],
)
def test_what_cannot_be_made_is_told_before_anything_is_rendered(
    dataset: Path,
    scene: Path,
    rig: rb.Rig,
    changed: dict,
    error: type,
    message: str,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(Stage, "of", refuse_to_render)
    before = files_of(dataset)
    with pytest.raises(error, match=message):
        rb.export_dataset(scene, rig, dataset, **{"motion": "sideways", "seeds": (0, 9), **SMALL, **changed})
    assert files_of(dataset) == before


def test_a_method_that_cannot_serve_the_rig_says_so_first(
    scene: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Stage, "of", refuse_to_render)
    lens = rb.Camera("equidistant", (200, 200), {"fx": 120, "fy": 120, "cx": 99.5, "cy": 99.5})
    behind = rb.Rig(lens, lens, np.diag([-1.0, 1.0, -1.0]), np.array([0.0, 0.0, -0.1]))
    with pytest.raises(rb.Unsupported, match="nothing in common"):
        rb.export_dataset(scene, behind, tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_a_folder_that_cannot_be_written_is_told_first(
    scene: Path, rig: rb.Rig, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Stage, "of", refuse_to_render)
    (tmp_path / "file").write_text("mine")
    with pytest.raises(InvalidInput, match="cannot be written"):
        rb.export_dataset(scene, rig, tmp_path / "file")


def test_lenses_that_a_format_lacks_and_that_look_far_aside_are_told(scene: Path, tmp_path: Path) -> None:
    lens = rb.Camera("equisolid", (64, 64), {"fx": 22, "fy": 22, "cx": 31.5, "cy": 31.5}, max_angle_deg=85)
    rig = rb.Rig(lens, lens, np.eye(3), [-0.1, 0, 0])
    rb.export_dataset(scene, rig, tmp_path, spp=1, quality="fast")
    (pair,) = json.loads((tmp_path / "dataset.json").read_text())["pairs"]
    assert set(pair["calibrations_not_written"]) == {"kalibr", "opencv"}
    assert "equisolid" in pair["calibrations_not_written"]["opencv"]
    assert not (tmp_path / "z_left").exists()
    readme = (tmp_path / "README.md").read_text()
    assert "the true rig: rig.yaml |" in readme
    assert "No depth along z is there" in readme
    assert 'opencv.yml"' not in readme


def test_what_has_no_place_in_16_bits_is_none(tmp_path: Path) -> None:
    disparity = np.array([[-1.0, 0.0, 0.001, 1.5, 255.99, 256.0, np.nan, np.inf]])
    (tmp_path / "d.png").write_bytes(encode.kitti_png(disparity))
    np.testing.assert_array_equal(read(tmp_path / "d.png"), [[0, 0, 0, 384, 65533, 0, 0, 0]])
    (tmp_path / "mm.png").write_bytes(encode.millimetres_png(np.array([[0.0014, 65.535, 65.536, np.nan]])))
    np.testing.assert_array_equal(read(tmp_path / "mm.png"), [[1, 65535, 0, 0]])


def test_the_command_line_exports(scene: Path, tmp_path: Path, shell: Shell) -> None:
    words = ("--width", 64, "--spp", 1, "--quality", "fast", "--method", "conventional")
    code, out, _ = shell("export", scene, "t265", "-o", tmp_path / "set", "--seeds", "2,3", *words)
    assert (code, out) == (0, f"{tmp_path / 'set'}: 2 pairs rendered, 0 there already\n")
    description = tmp_path / "set/rectified/description/000003"
    assert {file.name for file in description.iterdir()} == {"rectified.yaml", "opencv.yml"}
    code, _, err = shell("export", scene, "t265", "-o", tmp_path / "set", "--seeds", "two", *words)
    assert code == 2
    assert "--seeds is two; expected whole numbers" in err
