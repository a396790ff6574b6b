from __future__ import annotations

import math
import subprocess
import sys

import pytest

from rectbench.store.keys import canonical_json, code_digest, derived_seed, digest, versions


def test_order_of_names_is_no_part_of_a_key() -> None:
    assert digest({"a": 1, "b": [1, 2]}) == digest({"b": [1, 2], "a": 1})
    assert digest([1, 2]) != digest([2, 1])


def test_a_number_in_the_last_digit_changes_the_key() -> None:
    assert digest({"f": 0.1}) != digest({"f": math.nextafter(0.1, 1)})


def test_nan_has_no_key() -> None:
    with pytest.raises(ValueError, match="JSON compliant"):
        canonical_json({"f": math.nan})


def test_seeds_depend_on_identity_alone_and_are_equal_in_another_process() -> None:
    seed = derived_seed("pose", "street", "t265", 3)
    code = "from rectbench.store.keys import derived_seed; print(derived_seed('pose', 'street', 't265', 3))"
    other = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert int(other.stdout) == seed
    assert 0 <= seed < 2**32
    assert len({derived_seed("pose", "street", "t265", s) for s in range(100)}) == 100
    assert derived_seed("pose", "street", "t265", 3) != derived_seed("motion", "street", "t265", 3)


def test_code_digest_sees_the_sources_it_names() -> None:
    assert code_digest("rectbench.cameras.camera") != code_digest("rectbench.rigs.rig")
    with pytest.raises(ValueError, match=r"no module rectbench\.pears"):
        code_digest("rectbench.pears")


def test_a_package_that_is_not_installed_has_no_version() -> None:
    assert versions("numpy", "no-such-package-here")["no-such-package-here"] is None
    assert versions("numpy")["numpy"]
