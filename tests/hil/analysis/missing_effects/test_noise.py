"""Noise that a channel's readings prove."""

from __future__ import annotations

import numpy as np
import pytest

from hil.analysis.missing_effects._noise import proven_noise, rounding_step
from hil.analysis.missing_effects._series import series_of
from tests.hil.analysis.missing_effects.turning_mass import base, recording

SPEED = "motor_speed_rad_s"


def test_white_noise_is_read_from_the_top_of_the_spectrum() -> None:
    series = series_of(base(0.54), [recording(0.54, 2.17, noise_rad_s=0.05)])
    level = proven_noise(series, {})
    assert level[0] == pytest.approx(0.05 / 2.0, rel=0.1)  # means of four samples
    assert np.isnan(level[1:]).all()


def test_stated_noise_counts_where_it_is_larger() -> None:
    series = series_of(base(0.54), [recording(0.54, 2.17, noise_rad_s=0.05)])
    assert proven_noise(series, {SPEED: 0.4})[0] == pytest.approx(0.2)


@pytest.mark.parametrize("step", [0.63, 0.01])
def test_readings_on_a_grid_have_its_step(step: float) -> None:
    values = 20.0 * np.sin(np.linspace(0.0, 60.0, 40_000))
    assert rounding_step(np.round(values / step) * step) == pytest.approx(step, rel=1e-6)


def test_a_continuum_of_readings_has_no_step() -> None:
    assert rounding_step(np.random.default_rng(0).normal(size=10_000)) == 0.0
