from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rectbench as rb
from rectbench.errors import Unsupported
from rectbench.plugins.catalogue import known
from rectbench.plugins.figure import FigureData, Sources
from rectbench.reporting.charts.bars import pair_chart
from rectbench.reporting.charts.energy import Energy, shape_of
from rectbench.reporting.charts.grouped_bars import draw_bars
from rectbench.reporting.charts.squares import mapped_cells, source_squares
from rectbench.reporting.charts.timing import stage_chart
from rectbench.reporting.pictures.clouds import SIZE, Clouds
from rectbench.reporting.pictures.maps import DistortionMaps
from rectbench.reporting.pictures.pairs import RectifiedPairs
from rectbench.reporting.pictures.views import BACKGROUND, View, looking_at, painted, patches_of, two_views
from rectbench.reporting.style import BEYOND, looks
from rectbench.runs.run import Run, read_run
from tests.reporting.runs import METHODS, fake_pair, fake_rectification, fake_rig, make_row, quick_rows

WriteRun = Callable[..., Path]
RIG = fake_rig(160)
LOOKS = looks(tuple(METHODS))
RED, BLUE = np.array([(200, 0, 0), (0, 0, 200)], np.uint8)
AHEAD = looking_at(np.zeros(3), np.array([0.0, 0.0, 1.0]))


def given(run: Run, sources: Sources) -> FigureData:
    """What a figure of the whole run is made from."""
    return FigureData(run, run, sources, looks(run.methods))


def spot(where: Any) -> tuple[float, float]:
    """(u, v) of the middle of what is true."""
    v, u = np.nonzero(where)
    return float(u.mean()), float(v.mean())


def tiles(points: Any, colours: Any, view: View, size: tuple[int, int]) -> Any:
    """A picture of squares of 10 cm about points: two by two pixels of an image each, with gaps."""
    image = np.full((2, 3 * len(points), 3), np.nan)
    for column, across in ((0, -0.05), (1, 0.05)):
        for row, down in ((0, -0.05), (1, 0.05)):
            image[row, column::3] = points + np.array([across, down, 0.0])
    return painted(patches_of(image, np.repeat([colours], 3, axis=1).repeat(2, axis=0)), view, size)


def wall(across: int, nearest: float, farthest: float) -> tuple[Any, Any]:
    """Points [H, W, 3] and colours of a black wall, as an image of so many pixels across sees it."""
    u, v = np.meshgrid(np.linspace(-1, 1, across), np.linspace(-0.5, 0.5, across // 2))
    depth = 1 / (1 / nearest + (1 / farthest - 1 / nearest) * (u + 1) / 2)
    return np.stack([u, v, np.ones_like(u)], axis=-1) * depth[..., None], np.zeros((*u.shape, 3), np.uint8)


def test_the_nearer_surface_hides_the_farther_one() -> None:
    points = np.array([[0.0, 0.0, 2.0], [0.0, 0.0, 5.0]])
    for order in ([0, 1], [1, 0]):
        picture = tiles(points[order], np.array([RED, BLUE])[order], AHEAD, (41, 31))
        assert (picture[..., 0] > picture[..., 2]).any()
        assert not (picture[..., 2] > picture[..., 0]).any()


def test_what_is_behind_the_eye_or_no_number_is_not_drawn() -> None:
    points = np.array([[0.0, 0.0, -2.0], [np.nan, 0.0, 1.0], [0.0, 0.0, 0.0]])
    assert (tiles(points, np.zeros((3, 3), np.uint8), AHEAD, (41, 31)) == BACKGROUND).all()


def test_a_view_keeps_right_and_down() -> None:
    points = np.array([[1.0, 0.0, 4.0], [0.0, 0.5, 4.0]])
    picture = tiles(points, [RED, BLUE], AHEAD, (80, 60)).astype(int)
    assert spot(picture[..., 0] - picture[..., 2] > 50) == pytest.approx((60, 30), abs=1)
    assert spot(picture[..., 2] - picture[..., 0] > 50) == pytest.approx((40, 40), abs=1)


@pytest.mark.parametrize("across", [200, 640])
@pytest.mark.parametrize("eye", [(0.0, 0.0, 0.0), (4.0, -1.0, -1.0), (-3.0, -1.0, 2.0)])
def test_a_slanted_surface_is_closed_from_anywhere(across: int, eye: tuple[float, float, float]) -> None:
    points, colours = wall(across, 3.0, 9.0)
    middle = points[across // 4, across // 2]
    view = replace(looking_at(np.array(eye), middle), width=0.2)
    assert (painted(patches_of(points, colours), view, (120, 80)) == 0).all()


def test_two_surfaces_are_not_joined() -> None:
    points, colours = wall(200, 2.0, 2.0)
    points[:, 100:] *= 2
    view = replace(looking_at(np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 3.0])), width=0.1)
    assert (painted(patches_of(points, colours), view, (60, 40)) == BACKGROUND).all()


def test_views_show_most_of_what_both_cameras_see() -> None:
    _, truth = fake_pair(RIG)
    seen = truth.visible_left
    patches = patches_of(
        np.where(seen[..., None], truth.points_left, np.nan), np.zeros((*seen.shape, 3), np.uint8)
    )
    for view in two_views(truth.points_left[seen], SIZE):
        assert (painted(patches, view, SIZE) == 0).all(axis=-1).mean() > 0.3


def test_the_view_from_above_looks_through_the_ceiling() -> None:
    x, z = np.meshgrid(np.linspace(-2, 2, 90), np.linspace(0.5, 6, 90))
    floor, ceiling = (np.stack([x, np.full_like(x, y), z], axis=-1) for y in (1.0, -1.0))
    points = np.concatenate([floor, ceiling])
    colours = np.repeat(np.array([[RED], [BLUE]], np.uint8), 90, axis=0).repeat(90, axis=1)
    _, above = two_views(points.reshape(-1, 3), (80, 60))
    picture = painted(patches_of(points, colours), above, (80, 60))
    assert not (picture == BLUE).all(axis=-1).any()
    assert (picture == RED).all(axis=-1).mean() > 0.3


def test_squares_are_mapped_to_where_the_warp_takes_them() -> None:
    rect = fake_rectification(RIG, "abraham")
    squares = source_squares(RIG.left)
    cells = mapped_cells(rect.left, squares, rect.size)
    moved = rect.left.forward(squares)
    shown = ((moved > -0.5) & (moved < np.array(rect.size) - 0.5)).all(axis=2).any(axis=1)
    assert cells.outlines == pytest.approx(moved[shown])
    # The true area of a small cell is about S times its own.
    own, mapped = (_area(outlines) for outlines in (squares[shown], cells.outlines))
    assert mapped == pytest.approx(cells.areas * own, rel=0.02)


def _area(outlines: Any) -> Any:
    following = np.roll(outlines, -1, axis=1)
    cross = outlines[..., 0] * following[..., 1] - outlines[..., 1] * following[..., 0]
    return np.abs(cross.sum(axis=1)) / 2


def test_squares_beyond_the_output_are_left_out() -> None:
    rect = fake_rectification(RIG, "conventional")
    squares = source_squares(RIG.left)
    cells = mapped_cells(rect.left, squares, (40, 30))
    assert 0 < len(cells.outlines) < len(squares)
    assert (np.nanmin(cells.outlines, axis=1) < (40, 30)).all()


def test_the_shape_of_an_energy_holds_its_fit_in_the_middle() -> None:
    shape = shape_of("mine", fake_rectification(RIG, "local-homography"))
    at_fit = shape.slices[0].energy[20, 20]
    assert all(over.energy[20, 20] == pytest.approx(at_fit) for over in shape.slices)
    assert all(curve.energy[40] == pytest.approx(at_fit) for curve in shape.curves)


def test_methods_without_cubics_have_no_energy_to_show(write_run: WriteRun, sources: Sources) -> None:
    run = read_run(write_run([make_row("street", "t265", "exact", "abraham")]))
    with pytest.raises(Unsupported, match="abraham has no cubics"):
        Energy().draw(run.results, given(run, sources))
    run = read_run(write_run([make_row("street", "t265", "exact", "local-homography")]))
    assert len(Energy().draw(run.results, given(run, sources)).axes) == 4


def test_marks_are_whole_or_not_there(write_run: WriteRun, sources: Sources) -> None:
    run = read_run(write_run([make_row("street", "t265", "exact", "conventional")]))
    for ax in RectifiedPairs().draw(run.results, given(run, sources)).axes:
        rings = [line for line in ax.lines if line.get_marker() == "o"]
        assert rings
        assert len(ax.patches) % 2 == 0  # a box in each image
        height = max(image.get_extent()[2] for image in ax.images)
        for ring in rings:
            assert 0.02 * height < float(np.asarray(ring.get_ydata())[0]) < 0.98 * height


def test_boxes_are_equally_large_and_level_on_a_rectified_pair(write_run: WriteRun, sources: Sources) -> None:
    run = read_run(write_run([make_row("street", "t265", "exact", "abraham")]))
    source, rectified = RectifiedPairs().draw(run.results, given(run, sources)).axes
    for ax in (source, rectified):
        assert len({round(box.get_width(), 6) for box in ax.patches}) == 1
    left, right = rectified.patches[::2], rectified.patches[1::2]
    assert left
    assert [a.get_y() for a in left] == pytest.approx([b.get_y() for b in right], abs=0.05)
    off = [abs(a.get_y() - b.get_y()) for a, b in zip(source.patches[::2], source.patches[1::2], strict=True)]
    assert max(off) > 0.2


def test_what_lies_beyond_the_scale_has_a_colour_of_its_own(write_run: WriteRun, sources: Sources) -> None:
    run = read_run(write_run([make_row("street", "t265", "exact", "abraham")]))
    torn = replace(sources, distortion=lambda rect, rig, side, px: np.full(len(px), 1e7))
    figure = DistortionMaps().draw(run.results, given(run, torn))
    shades = figure.axes[0].images[0].get_array()
    assert shades is not None
    wanted = [int(BEYOND[i : i + 2], 16) / 255 for i in (1, 3, 5)]
    assert np.isclose(np.asarray(shades)[..., :3], wanted).all(axis=-1).any()
    assert "> 100" in [text.get_text() for text in figure.axes[-1].texts]


def test_protocols_stand_side_by_side_with_the_pairs_below(write_run: WriteRun) -> None:
    run = read_run(write_run(quick_rows(scenes=("street", "room"), rigs=("t265",), poses=("exact",))))
    protocols = known().panels("Distortion")
    chart = pair_chart(run, "L", protocols, "exact")
    shown = [title for key, title in protocols.items() if key in run.metrics]
    assert list(chart.panels) == shown
    assert list(chart.panels[shown[0]]) == ["street\nt265", "room\nt265"]
    axes = draw_bars(chart, LOOKS).axes[: len(shown)]
    assert [ax.get_title() for ax in axes] == shown


def test_stated_times_are_lines_with_their_number(write_run: WriteRun) -> None:
    row = make_row("street", "t265", "exact", "abraham", total_s=0.1)
    chart = stage_chart(read_run(write_run([row])), known().panels("Time"), {"fit": 3.0, "total": 15.0})
    ax = draw_bars(chart, LOOKS).axes[0]
    assert [text.get_text() for text in ax.texts] == ["3", "15"]
    assert ax.get_yscale() == "log"
    assert ax.get_ylim()[1] > 15


def test_clouds_without_a_truth_have_a_row_a_method_and_one_view_of_all(
    write_run: WriteRun, sources: Sources
) -> None:
    run = read_run(write_run([make_row("a", "t265", "calibrated", m) for m in ("abraham", "conventional")]))
    known = replace(sources.pair(run.results[0]), knows_truth=False)
    figure = Clouds().draw(run.results, given(run, replace(sources, pair=lambda result: known)))
    pictures = [np.asarray(ax.images[0].get_array()) for ax in figure.axes if ax.images]
    assert len(pictures) == 4
    assert np.array_equal(pictures[0], pictures[2])  # the same perfect cloud, seen from the same place
    assert (pictures[0] != BACKGROUND).any()
    assert [text.get_text() for text in figure.axes[0].texts][:1] != ["truth"]


def test_a_photographed_pair_without_matches_is_shown_without_marks(
    write_run: WriteRun, sources: Sources
) -> None:
    run = read_run(write_run([make_row("a", "t265", "calibrated", "abraham")]))
    nothing = rb.Matches(np.empty((0, 2)), np.empty((0, 2)))
    known = replace(sources.pair(run.results[0]), matches=nothing, knows_truth=False)
    figure = RectifiedPairs().draw(run.results, given(run, replace(sources, pair=lambda result: known)))
    for ax in figure.axes:
        assert ax.images
        assert not ax.patches
        assert not [line for line in ax.lines if line.get_marker() == "o"]
