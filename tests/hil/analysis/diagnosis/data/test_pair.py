"""Two things that go together, by their sums."""

import numpy as np
import pytest

from hil.analysis.diagnosis.data.turns import Pair


def test_sign_and_factor_of_two_things() -> None:
    x = np.random.default_rng(1).normal(size=500)
    pair = Pair()
    pair.add(x[:200], -3.0 * x[:200])
    pair.add(x[200:], -3.0 * x[200:])
    assert (pair.count, pair.correlation, pair.factor) == (500, pytest.approx(-1.0), pytest.approx(3.0))
    assert pair.sizes == pytest.approx((np.sqrt(np.mean(x**2)), 3.0 * np.sqrt(np.mean(x**2))))


def test_nothing_goes_with_nothing() -> None:
    assert (Pair().correlation, Pair().factor, Pair().sizes) == (0.0, 0.0, (0.0, 0.0))
