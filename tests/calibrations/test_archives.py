"""NumPy's archives are read as OpenCV's other files are, and refused where they hold something else."""

from __future__ import annotations

import io
import zipfile
from pathlib import Path

import numpy as np
import pytest

from rectbench import InvalidInput, load_rig
from tests.calibrations.calibration_files import D1, D2, K1, K2, R_RIGHT_LEFT, T_RIGHT_LEFT
from tests.calibrations.examples.exports import archive
from tests.calibrations.test_every_format import assert_same_rig

RIG = {"K1": K1, "D1": np.r_[-0.2, 0.05, 1e-3, -2e-3, 0.01], "K2": K2, "D2": np.r_[-0.1, 0.0, 0, 0, 0]}
RIG |= {"R": R_RIGHT_LEFT, "T": T_RIGHT_LEFT, "imageSize": np.array([848, 800])}


def saved(folder: Path, content: bytes) -> Path:
    path = folder / "stereo.npz"
    path.write_bytes(content)
    return path


def test_an_archive_larger_than_a_calibration_is_read_for_its_matrices(tmp_path: Path) -> None:
    small = load_rig(saved(tmp_path, archive(**RIG)))
    maps = {f"map{number}": np.random.default_rng(number).normal(size=(800, 848)) for number in range(2)}
    path = saved(tmp_path, archive(**maps, **RIG))
    assert path.stat().st_size > 8 << 20
    assert_same_rig(load_rig(path), small)


def test_compressed_archives_and_every_kind_of_number_are_read(tmp_path: Path) -> None:
    expected = load_rig(saved(tmp_path, archive(**RIG | {"D1": np.zeros(5), "K1": K1.astype(np.float32)})))
    stream = io.BytesIO()
    np.savez_compressed(stream, **RIG | {"D1": np.zeros(5, np.int8), "K1": K1.astype(">f4")})
    assert_same_rig(load_rig(saved(tmp_path, stream.getvalue())), expected)


def test_a_zip_bomb_is_left_closed(tmp_path: Path) -> None:
    stream = io.BytesIO(archive(**RIG))
    with zipfile.ZipFile(stream, "a", zipfile.ZIP_DEFLATED) as zipped:
        zipped.writestr("points.npy", bytes(64 << 20))
    path = saved(tmp_path, stream.getvalue())
    assert path.stat().st_size < 1 << 18
    assert load_rig(path).left.size == (848, 800)


def test_four_coefficients_that_can_hardly_be_a_pinhole_s_ask_for_the_lens(tmp_path: Path) -> None:
    path = saved(tmp_path, archive(**RIG | {"D1": D1, "D2": D2}))
    with pytest.raises(InvalidInput, match="more of a fisheye's than a pinhole's; expected `model: fisheye`"):
        load_rig(path)


def with_entry(name: str, content: bytes) -> bytes:
    stream = io.BytesIO(archive(**RIG))
    with zipfile.ZipFile(stream, "a") as zipped:
        zipped.writestr(name, content)
    return stream.getvalue()


def header(text: str) -> bytes:
    """An array of no bytes whose header, of version 1.0, is that text."""
    return b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text.encode()


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (
            archive(**RIG, calibration=np.array({"K1": 1}, dtype=object)),
            "holds Python objects, which are not",
        ),
        (archive(K1=K1)[:-30], "is no .npz archive"),
        (with_entry("weights.bin", b"1"), "holds 'weights.bin', which is no array"),
        (with_entry("x.npy", b"\x93NUMPY\x09\x00"), "has an array of version 9.0"),
        (with_entry("x.npy", b"x"), "holds 'x.npy', which is no array"),
        (
            with_entry("x.npy", header("{'descr': '<f8', 'fortran_order': False, 'shape': (9999999, 99)}\n")),
            r"has an array of 0 bytes that says it is \(9999999, 99\) of float64",
        ),
        (
            with_entry(
                "x.npy", header("{'descr': '<M8[s]', 'fortran_order': False, 'shape': (1,)}\n") + bytes(8)
            ),
            "has an array of datetime64",
        ),
        (archive(**{f"a{number}": 0 for number in range(201)}), "has over 200 arrays"),
    ],
)
def test_what_is_no_archive_of_numbers_is_refused_in_one_line(
    tmp_path: Path, content: bytes, reason: str
) -> None:
    path = saved(tmp_path, content)
    with pytest.raises(InvalidInput, match=reason) as caught:
        load_rig(path)
    assert str(caught.value).startswith(f"{path}: ")
    assert str(caught.value).isprintable()
