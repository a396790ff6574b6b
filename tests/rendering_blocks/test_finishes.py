"""Finishes are physical, seamless, repeatable and of the right scale."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from rectbench.rendering import blocks as b
from rectbench.rendering.blocks.prints import Prints
from rectbench.rendering.blocks.shape import Finish

GREY = (0.3, 0.3, 0.3)

FINISHES: dict[str, Callable[[int], Finish]] = {
    "asphalt": b.asphalt, "bark": b.bark, "birch_bark": b.birch_bark, "brick": b.brick,
    "ceiling_board": b.ceiling_board, "cloth": lambda seed: b.cloth(seed, GREY), "concrete": b.concrete,
    "enamel": lambda seed: b.enamel(seed, GREY), "floorboards": b.floorboards,
    "forest_floor": b.forest_floor, "glazed_tiles": b.glazed_tiles, "gravel": b.gravel, "lawn": b.lawn,
    "paving": b.paving, "plaster": lambda seed: b.plaster(seed, GREY), "roof_tiles": b.roof_tiles,
    "stone_wall": b.stone_wall, "terrazzo": b.terrazzo, "timber": b.timber,
    "wall_paint": lambda seed: b.wall_paint(seed, GREY), "wallpaper": b.wallpaper,
}  # fmt: skip
PRINTS: dict[str, Callable[[int], Prints]] = {
    "book_spines": b.book_spines, "foliage": b.foliage, "parcels": b.parcels, "posters": b.posters,
    "window_panes": b.window_panes,
}  # fmt: skip
ALL = {**FINISHES, "rug": b.rug, **{name: lambda seed, of=of: of(seed).finish for name, of in PRINTS.items()}}


def texels(finish: Finish) -> np.ndarray:
    return np.asarray(finish.material.reflectance)


@pytest.mark.parametrize("name", ALL)
def test_reflectance_is_physical(name: str) -> None:
    image = texels(ALL[name](0))
    assert image.dtype == np.float32
    assert image.ndim == 3
    assert image.shape[2] == 3
    assert image.min() >= 0.02 - 1e-6
    assert image.max() <= 0.95 + 1e-6


@pytest.mark.parametrize("name", ALL)
def test_a_seed_always_gives_the_same_texture_and_another_seed_another(name: str) -> None:
    first, again, other = texels(ALL[name](3)), texels(ALL[name](3)), texels(ALL[name](4))
    np.testing.assert_array_equal(first, again)
    assert not np.array_equal(first, other)


@pytest.mark.parametrize("name", ALL)
def test_no_surface_is_flat(name: str) -> None:
    grey = texels(ALL[name](0)).mean(axis=2)
    assert grey.std() > 0.05 * grey.mean()


@pytest.mark.parametrize("name", FINISHES)
def test_texture_repeats_without_a_seam(name: str) -> None:
    grey = texels(FINISHES[name](0)).mean(axis=2)
    for image in (grey, grey.T):
        across_seam = np.abs(image[0] - image[-1]).mean()
        inside = np.abs(np.diff(image, axis=0)).mean(axis=1)
        assert across_seam <= 1.2 * inside.max()


def test_a_brick_is_24_cm_long_and_7_cm_high() -> None:
    wall = b.brick(0, rows=64, columns=32)
    np.testing.assert_allclose(wall.tile_m, (32 * 0.24, 64 * 0.07))
    grey = texels(wall).mean(axis=2)
    spectrum = np.abs(np.fft.rfft(grey.mean(axis=1) - grey.mean()))
    assert spectrum.argmax() == 64  # mortar joints: one dark line a course


@pytest.mark.parametrize("name", PRINTS)
def test_a_print_stays_within_its_cell(name: str) -> None:
    prints = PRINTS[name](0)
    for index in range(prints.count):
        ((shape, finish),) = prints.on(b.panel(1, 1), index).parts
        row, column = divmod(index, prints.columns)
        assert finish is prints.finish
        cell = shape.uv * (prints.columns, prints.rows) - (column, row)
        assert 0.0 < cell.min() < cell.max() < 1.0


def test_prints_are_not_mixed_up_or_upside_down() -> None:
    from rectbench.rendering.blocks.prints import sheet

    pictures = np.zeros((4, 3, 8, 8), dtype=np.float32)
    for index in range(4):
        pictures[index, :, :4] = 0.2 * (index + 1)  # the upper half
    image = texels(sheet("sheet", pictures, 2).finish)[..., 0]
    for index in range(4):
        row, column = divmod(index, 2)
        cell = image[8 * row : 8 * row + 8, 8 * column : 8 * column + 8]
        # A texture's row grows with v, and a panel's v grows upwards.
        np.testing.assert_allclose(cell[4:], 0.2 * (index + 1), rtol=1e-6)
        np.testing.assert_allclose(cell[:4], 0.02, rtol=1e-6)
