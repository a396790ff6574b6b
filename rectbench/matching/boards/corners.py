"""Corners of a calibration board that both images show, matched by the board itself.

They are the matches to trust: the board tells which corner is which, so that none is wrong, and a corner is
found to a few hundredths of a pixel. On boards on a 640 px fisheye with noise of 2 grey levels,
`cv2.cornerSubPix` is off by 0.02 px (RMS of a coordinate) where pixels are means of 64 samples, and by
0.045 px where they are of 9, noisier at edges; in smaller windows and unsmoothed, by 0.034 and 0.062 px.
OpenCV's own corners, from which the search starts here, are off by up to half a pixel under a fisheye lens.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from rectbench.images.reading import Grey, grey8
from rectbench.matching.boards.saddles import levels_at, refined_saddles
from rectbench.matching.boards.tags import tags
from rectbench.types import FloatArray, Matches

LEAST_TAGS = 4
"""Tags seen in both images; of fewer, a chance pattern may be one."""
NEIGHBOURS, AGREEMENT_STEPS = 12, 10
"""Neighbours of a tag's corner that predict its place, and steps of the robust fit to them."""
AGREEING_PX, WITHIN_MEDIANS = 0.5, 4.0
"""A corner farther off than both, the latter times the median, is not the same in both images."""
EXHAUSTIVE = cv2.CALIB_CB_LARGER | cv2.CALIB_CB_EXHAUSTIVE
SEARCHES = (
    (1.0, (4, 4), cv2.CALIB_CB_LARGER),
    (1.0, (6, 5), cv2.CALIB_CB_LARGER),
    (1.0, (4, 4), EXHAUSTIVE),
    (1.5, (4, 4), EXHAUSTIVE),
)
"""Searches in their turn: how much larger the image is made, the grid to begin with, and OpenCV's flags. Of a
bent board it misorders some grids; far and tilted ones before a busy background only the last two find."""
ABOUT, SIZES_ABOUT, SIDE_ABOUT, MOST_ENLARGED = 3.0, ((4, 4), (6, 5)), 30.0, 4.0
"""Where a grid found is no whole board, it is searched for once more: so many squares about it, enlarged
until a side has so many px, or by the last. Of small squares OpenCV misses some, or takes others for them."""
LEAST_ROWS = 3
"""Corners along a side of the grid from which on it may grow."""
LEAST_CORNERS = 20
"""Corners on a chessboard; smaller grids are found in gravel and foliage."""
SEARCHED_PIXELS = 1_000_000
"""A chessboard is searched for on an image of so many pixels; its corners are refined on the image itself."""
LEAST_CONTRAST = 20.0
"""Grey levels between dark squares and light ones, the median."""
EVEN_CONTRAST = 0.3
"""Of the median contrast, what each square must have to its neighbours."""
NEAR_GUESS, WITHIN_SQUARE = 0.35, 0.3
"""How far a further corner may be from where it is expected, and how far from it squares are looked at;
in squares."""
RIM = 0.3
"""How far beyond its outer squares the board is looked for to go on, in squares."""
GOES_ON = 0.5
"""Share of the contrast at which the squares still alternate beyond the board: it is cut off there."""
UPRIGHT_DEG = 60.0
"""Where a board looks the same upside down, the images may be turned against each other by so much."""
WINDOW, LEAST_WINDOW, MOST_WINDOW = 0.45, 2, 14
"""Half the window in which a corner is refined: a share of the shortest square's side, and px."""
SMOOTHING, SMOOTHED_WINDOW = 1.0, 4
"""Blur, px, that takes a quarter of the noise's effect away, and half the window from which on it may."""


@dataclass(frozen=True, eq=False)
class BoardMatches:
    """The corners of one board in both images.

    >>> import numpy as np
    >>> import rectbench as rb
    >>> corners = np.array([[10.0, 20.0], [30.0, 20.0]])
    >>> found = rb.BoardMatches(rb.Matches(corners, corners - [5, 0]), "chessboard 2x1")
    >>> (found.matches.left - found.matches.right)[:, 0]
    array([5., 5.])
    """

    matches: Matches
    """[N, 2] each."""
    kind: str
    """What the board is: "chessboard 9x6" (corners within it), or "AprilTag 36h11, 34 tags"."""


def board_matches(left: NDArray[np.generic], right: NDArray[np.generic]) -> BoardMatches | None:
    """The corners of the chessboard, or of the tags, that both images show; None where they show none.

    Images are [H, W] or [H, W, 1 to 4 channels], of any depth. A chessboard is of any size, whole in both
    images with its outer squares; where turning it by 180° changes nothing, the images are taken to be
    upright alike. Of tags (AprilTag 36h11, with Kalibr's border, too, and ArUco) four have to be in both
    images. Raises InvalidInput for arrays that are no images.

    >>> import numpy as np
    >>> import rectbench as rb
    >>> squares = np.kron(np.indices((7, 9)).sum(axis=0) % 2, np.ones((16, 16)))
    >>> image = np.pad(np.uint8(255 * squares), 24, constant_values=255)
    >>> found = rb.board_matches(image, np.roll(image, -5, axis=1))
    >>> found.kind
    'chessboard 8x6'
    >>> np.ptp(found.matches.left - found.matches.right, axis=0).round(2)
    array([0., 0.])
    """
    images = grey8(left, "left"), grey8(right, "right")
    return _tag_matches(*images) or _chessboard_matches(*images)


def _tag_matches(left: Grey, right: Grey) -> BoardMatches | None:
    best: BoardMatches | None = None
    found_left = tags(left)
    if not any(len(seen) >= LEAST_TAGS for seen in found_left.values()):
        return None
    found_right = tags(right)
    for family in sorted(found_left.keys() & found_right.keys()):
        seen, others = found_left[family], found_right[family]
        common = sorted(seen.keys() & others.keys())
        if len(common) < LEAST_TAGS:
            continue
        corners = [np.stack([tag[one] for one in common]).reshape(-1, 2) for tag in (seen, others)]
        found = np.isfinite(corners).all(axis=(0, 2))
        if found.sum() < 4 * LEAST_TAGS:
            continue
        matches = _agreeing(Matches(corners[0][found], corners[1][found]))
        if best is None or len(matches.left) > len(best.matches.left):
            best = BoardMatches(matches, f"{family}, {len(common)} tags")
    return best


def _agreeing(matches: Matches) -> Matches:
    """The matches [N, 2] that lie where their neighbours predict, by a local affine map from left to right.

    A tag's corner may be mistaken for one of the square beside it, in one image and not in the other.
    """
    if len(matches.left) <= NEIGHBOURS:
        return matches
    near = np.asarray(cKDTree(matches.left).query(matches.left, NEIGHBOURS + 1)[1])[:, 1:]
    steps = matches.left[near] - matches.left[:, None]
    places = np.concatenate([steps / np.abs(steps).mean(), np.ones((*near.shape, 1))], axis=-1)
    images = matches.right[near] - matches.right[:, None]
    weights = np.ones(near.shape)
    for _ in range(AGREEMENT_STEPS):
        weighted = np.swapaxes(places * weights[..., None], 1, 2)
        fit = np.linalg.solve(weighted @ places + 1e-9 * np.eye(3), weighted @ images)
        misses = np.linalg.norm(places @ fit - images, axis=-1)
        weights = 1 / (1 + (misses / AGREEING_PX) ** 2) ** 2
    off_px = np.linalg.norm(fit[:, 2], axis=-1)
    kept = off_px <= max(AGREEING_PX, WITHIN_MEDIANS * float(np.median(off_px)))
    return Matches(matches.left[kept], matches.right[kept])


@dataclass(frozen=True, eq=False)
class _Chessboard:
    corners: FloatArray
    """The inner corners [R, C, 2], seen from before the board: columns to the right of rows."""
    dark_first: bool
    """Whether the square within the first four corners is a dark one."""

    @property
    def along_row(self) -> complex:
        """The mean step along a row, x + iy."""
        step = np.diff(self.corners, axis=1).mean(axis=(0, 1))
        return complex(*step)

    def turned(self) -> Iterator[_Chessboard]:
        """The same board begun at each of its four corners."""
        rows, columns = self.corners.shape[:2]
        dark = np.add.outer(np.arange(rows - 1), np.arange(columns - 1)) % 2 == (0 if self.dark_first else 1)
        for quarter in range(4):
            yield _Chessboard(np.rot90(self.corners, quarter), bool(np.rot90(dark, quarter)[0, 0]))


def _chessboard_matches(left: Grey, right: Grey) -> BoardMatches | None:
    seen = _chessboard(left)
    other = None if seen is None else _chessboard(right)
    if seen is None or other is None:
        return None
    alike = [
        board
        for board in other.turned()
        if board.corners.shape == seen.corners.shape and board.dark_first == seen.dark_first
    ]
    if not alike:
        return None
    angles = [abs(np.angle(board.along_row / seen.along_row, deg=True)) for board in alike]
    if len(alike) > 1 and min(angles) > UPRIGHT_DEG:
        return None
    chosen = alike[int(np.argmin(angles))]
    sides = sorted(seen.corners.shape[:2], reverse=True)
    matches = Matches(seen.corners.reshape(-1, 2), chosen.corners.reshape(-1, 2))
    return BoardMatches(matches, f"chessboard {sides[0]}x{sides[1]}")


def _chessboard(image: Grey) -> _Chessboard | None:
    """The one whole chessboard in the image, if there is one."""
    reduction = min(1.0, np.sqrt(SEARCHED_PIXELS / image.size))
    for factor, size, flags in SEARCHES:
        grid = _seen_grid(image, factor * reduction, size, flags)
        board = None if grid is None else _whole_board(image, grid) or _board_about(image, grid)
        if board is not None:
            return board
    return None


def _seen_grid(image: Grey, factor: float, size: tuple[int, int], flags: int) -> FloatArray | None:
    """The grid [R, C, 2] that OpenCV finds in the image made larger by `factor`, in the image's pixels."""
    interpolation = cv2.INTER_AREA if factor < 1 else cv2.INTER_CUBIC
    searched = image
    if factor != 1:
        searched = cv2.resize(image, None, fx=factor, fy=factor, interpolation=interpolation)
    enlarged = np.array(searched.shape[::-1]) / image.shape[::-1]
    found, corners, meta = cv2.findChessboardCornersSBWithMeta(searched, size, flags)
    if not found or meta is None:
        return None
    return np.asarray((corners.reshape(*meta.shape, 2).astype(np.float64) + 0.5) / enlarged - 0.5)


def _board_about(image: Grey, grid: FloatArray) -> _Chessboard | None:
    """The whole chessboard of which `grid` [R, C, 2] seems a part, searched for about it, made larger."""
    side = float(np.median(_sides(grid)))
    reach = grid.reshape(-1, 2) + ABOUT * side * np.array([[[-1.0]], [[1.0]]])
    low = np.floor(np.clip(reach.min(axis=(0, 1)), 0, None)).astype(int)
    high = np.ceil(reach.max(axis=(0, 1))).astype(int)
    about = np.ascontiguousarray(image[low[1] : high[1], low[0] : high[0]])
    for size in SIZES_ABOUT:
        larger = _seen_grid(about, min(SIDE_ABOUT / side, MOST_ENLARGED), size, EXHAUSTIVE)
        board = None if larger is None else _whole_board(image, larger + low)
        if board is not None:
            return board
    return None


def _whole_board(image: Grey, grid: FloatArray) -> _Chessboard | None:
    """The board of which `grid` [R, C, 2] is a part; None where that is no part of a whole chessboard."""
    step_right, step_down = (np.diff(grid, axis=axis).mean(axis=(0, 1)) for axis in (1, 0))
    if step_right[0] * step_down[1] < step_right[1] * step_down[0]:
        grid = grid.swapaxes(0, 1)
    grid = _found_part(_refined(image, grid, _sides(grid)))
    if min(grid.shape[:2]) < LEAST_ROWS:
        return None
    grid = _grown(image, grid)
    # The edge of the board and what is behind it may look like one more row.
    for part in (grid, grid[1:], grid[:-1], grid[:, 1:], grid[:, :-1]):
        if min(part.shape[:2]) < LEAST_ROWS or part[..., 0].size < LEAST_CORNERS:
            continue
        alternation = _alternation(image, part)
        if alternation != 0:
            return _Chessboard(part, alternation < 0)
    return None


def _found_part(grid: FloatArray) -> FloatArray:
    """The corners [R, C, 2] without outer rows and columns some of whose are not found (NaN)."""
    while min(grid.shape[:2]) >= LEAST_ROWS:
        found = np.asarray(np.isfinite(grid).all(axis=-1))
        if found.all():
            break
        outer = [found[0], found[-1], found[:, 0], found[:, -1]]
        side = int(np.argmin([row.mean() for row in outer]))
        grid = (grid[1:], grid[:-1], grid[:, 1:], grid[:, :-1])[side]
    return grid


def _grown(image: Grey, grid: FloatArray) -> FloatArray:
    """The corners [R, C, 2] with rows and columns beyond them: OpenCV stops where a lens bends a board."""
    blurred, kept = cv2.blur(image, (3, 3)), 0
    while kept < 4:
        row = _next_row(image, blurred, grid)
        kept = kept + 1 if row is None else 0
        grid = np.rot90(grid if row is None else np.concatenate([row[None], grid]))
    return grid


def _next_row(image: Grey, blurred: Grey, grid: FloatArray) -> FloatArray | None:
    """The corners [C, 2] before the first row, where squares meet there, dark and light in turn; or None."""
    guess = 3 * grid[0] - 3 * grid[1] + grid[2]
    height, width = image.shape
    if not np.isfinite(guess).all() or guess.min() < 1 or (guess > [width - 2, height - 2]).any():
        return None
    row = _refined(image, guess, _sides(np.stack([guess, grid[0]])))
    back, along = row - grid[0], np.gradient(row, axis=0)
    shortest = min(np.linalg.norm(back, axis=-1).min(), np.linalg.norm(along, axis=-1).min())
    if not np.linalg.norm(row - guess, axis=-1).max() <= NEAR_GUESS * shortest:
        return None
    steps = [[WITHIN_SQUARE * (end * along + tilt * end * back) for end in (-1, 1)] for tilt in (1, -1)]
    rising, falling = (np.stack([levels_at(blurred, row + step) for step in ends]) for ends in steps)
    even = np.arange(len(row)) % 2 == 0
    for light, dark in ((rising, falling), (falling, rising)):
        contrast = np.where(even, light.min(axis=0) - dark.max(axis=0), dark.min(axis=0) - light.max(axis=0))
        if contrast.min() > LEAST_CONTRAST:
            return np.asarray(row)
    return None


def _alternation(image: Grey, grid: FloatArray) -> int:
    """Whether the first square within the corners [R, C, 2] is light (1) or dark (-1); 0: no whole board.

    All squares, the outer ones that the corners only bound from within included, have to be dark and
    light in turn, and beyond these nothing may go on so: a board that is cut off could be taken for a
    shifted one.
    """
    ringed = _with_ring(_with_ring(grid).swapaxes(0, 1)).swapaxes(0, 1)
    rows, columns = (length - 1 for length in ringed.shape[:2])
    signs = (-1.0) ** np.add.outer(np.arange(rows), np.arange(columns))
    blurred = cv2.blur(image, (3, 3))
    grey = levels_at(blurred, (ringed[:-1, :-1] + ringed[1:, :-1] + ringed[:-1, 1:] + ringed[1:, 1:]) / 4)
    if not np.isfinite(grey).all():
        return 0
    padded = np.pad(grey, 1, mode="reflect")
    contrast = signs * (grey - (padded[:-2, 1:-1] + padded[2:, 1:-1]) / 2)
    contrast_along = signs * (grey - (padded[1:-1, :-2] + padded[1:-1, 2:]) / 2)
    median = float(np.median(contrast))
    least = EVEN_CONTRAST * abs(median)
    lowest = min((np.sign(median) * c).min() for c in (contrast, contrast_along))
    if abs(median) < LEAST_CONTRAST or lowest < least:
        return 0
    for side in range(4):
        turned, sign = np.rot90(ringed, side), np.rot90(signs, side)[0]
        beyond = turned[0] + RIM * (turned[0] - turned[1])
        outside = levels_at(blurred, (beyond[:-1] + beyond[1:]) / 2)
        if not np.isfinite(outside).all():
            return 0
        going_on = -np.mean(sign * (outside - outside.mean())) / (median / 2)
        if going_on > GOES_ON:
            return 0
    return int(np.sign(median))


def _with_ring(grid: FloatArray) -> FloatArray:
    """Corners [R, C, 2] with a row before the first and one after the last, on a parabola through three."""
    first, last = (3 * rows[0] - 3 * rows[1] + rows[2] for rows in (grid, grid[::-1]))
    return np.concatenate([first[None], grid, last[None]])


def _refined(image: Grey, corners: FloatArray, sides: FloatArray) -> FloatArray:
    """Corners [..., 2] to a fraction of a pixel, of squares with `sides` px; NaN where there is none."""
    half = int(np.clip(WINDOW * sides.min(), LEAST_WINDOW, MOST_WINDOW))
    smooth = (
        image if half < SMOOTHED_WINDOW else cv2.GaussianBlur(image.astype(np.float32), (0, 0), SMOOTHING)
    )
    return refined_saddles(smooth, corners, half)


def _sides(grid: FloatArray) -> FloatArray:
    """Lengths [...] of the squares' sides between corners [R, C, 2], px."""
    return np.concatenate([np.linalg.norm(np.diff(grid, axis=axis), axis=-1).ravel() for axis in (0, 1)])
