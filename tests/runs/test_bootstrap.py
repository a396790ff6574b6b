from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import bootstrap

from rectbench.runs.bootstrap import interval


def test_clusters_of_one_are_the_ordinary_percentile_bootstrap() -> None:
    values = np.random.default_rng(2).gamma(2.0, size=25)
    found = interval(list(values[:, None, None]), lambda x: np.median(x[..., 0, 0], axis=-1), 2000)
    known = bootstrap(
        (values,), np.median, n_resamples=2000, method="percentile", rng=np.random.default_rng(0)
    ).confidence_interval
    assert found == pytest.approx((known.low, known.high), rel=1e-12)
