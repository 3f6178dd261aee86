"""Readings that lie on a grid."""

import numpy as np
import pytest

from hil.plant import rounding_step


@pytest.mark.parametrize("step", [0.01, 0.25, 3.0])
def test_the_step_of_a_grid_is_found(step: float) -> None:
    values = np.random.default_rng(1).normal(0.0, 10.0 * step, 4000)
    assert rounding_step(np.round(values / step) * step) == pytest.approx(step, rel=1e-6)
    assert rounding_step(values) == 0.0


def test_a_constant_lies_on_no_grid() -> None:
    assert rounding_step(np.full(1000, 2.0)) == 0.0


def test_digits_of_a_text_do_not_make_levels() -> None:
    """A servo's speed in steps of 0.0239808 rad/s, written with six digits."""
    counts = np.random.default_rng(3).integers(-100, 100, 1100)
    noisy = np.round(counts * 0.0239808 + np.random.default_rng(4).choice([0.0, 1e-6], 1100), 6)
    assert rounding_step(noisy) == pytest.approx(0.02398, rel=1e-3)
