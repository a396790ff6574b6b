"""Levels of matches: how they are spelled, and that true ones never go unsaid."""

from __future__ import annotations

import pytest

import rectbench as rb
from rectbench.plugins.matches import marked, match_level, true_noise_px


@pytest.mark.parametrize(
    ("stated", "spelled", "noise_px"),
    [
        ("images", "images", None),
        ("true", "true", 0.0),
        ("true + 0.1 px", "true + 0.1 px", 0.1),
        ("true+.10px", "true + 0.1 px", 0.1),
        ("true + 2 px", "true + 2 px", 2.0),
        ("true + 0.0 px", "true", 0.0),
    ],
)
def test_a_level_has_one_spelling_and_a_noise(stated: str, spelled: str, noise_px: float | None) -> None:
    assert match_level(stated) == spelled
    assert match_level(spelled) == spelled
    assert true_noise_px(spelled) == noise_px


@pytest.mark.parametrize(
    "stated", ["", "truth", "true + px", "true + -1 px", "true + nan px", "0.1 px", "Images"]
)
def test_what_is_no_level_is_refused_in_a_line(stated: str) -> None:
    with pytest.raises(rb.InvalidInput, match="expected images, true, or true \\+ N px") as caught:
        match_level(stated)
    assert "\n" not in str(caught.value)


def test_methods_are_marked_where_they_got_true_matches_and_nowhere_else() -> None:
    assert marked("hartley", "true + 0.1 px") == "hartley (true matches + 0.1 px)"
    assert marked("hartley", "true", "focal=1") == "hartley (focal=1, true matches)"
    assert marked("hartley", "images") == marked("hartley", "") == "hartley"
