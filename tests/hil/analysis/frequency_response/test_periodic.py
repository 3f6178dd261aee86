from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import signal

from hil.analysis.frequency_response import (
    Experiment,
    FrequencyResponse,
    UnfitDataError,
    best_linear_approximation,
    estimate,
    period_samples,
)
from hil.core.channels import OUTPUTS
from test_plans import stimuli
from tests.hil.analysis import paper_plant

STEP = 0.001
PERIOD_S = 4.0


def experiment(
    seed: int, *, cubic: float = 0.0, square: float = 0.0, noise: float = 0.01, odd_only: bool = True
) -> Experiment:
    """A lag of 20 rad/s behind a static nonlinearity, excited by a multisine with some odd lines missing."""
    lines = stimuli.multisine_lines(0.25, 25, PERIOD_S, odd_only=odd_only)
    if odd_only:
        lines = [line for i, line in enumerate(lines) if i % 4 != 3]
    torque = stimuli.multisine(lines, PERIOD_S, 6, seed, STEP, rms=1.0, fade_s=0.5)
    decay = np.exp(-20 * STEP)
    bent = torque + square * torque**2 + cubic * torque**3
    speed = signal.lfilter([0.0, 1 - decay], [1.0, -decay], bent)
    rng = np.random.default_rng(seed + 1000)
    speed = speed + noise * rng.standard_normal(len(speed))
    return Experiment("multisine", STEP, torque, speed[None, :], OUTPUTS[:1], hold_s=STEP, kind="multisine")


def bla(**options: Any) -> FrequencyResponse:
    experiments = [experiment(seed, **options) for seed in range(4)]
    return best_linear_approximation(experiments, round(PERIOD_S / STEP), 0.25, 25)


def truth(frf: FrequencyResponse) -> np.ndarray:
    return np.asarray(20 / (2j * np.pi * frf.frequency_hz + 20))


@given(st.integers(200, 900), st.integers(2, 5), st.integers(0, 150), st.integers(0, 2**31))
@settings(max_examples=30, deadline=None)
def test_period_is_found_between_rest_and_fades(period: int, periods: int, rest: int, seed: int) -> None:
    lines = list(range(1, period // 10, 2))
    torque = stimuli.multisine(lines, period * STEP, periods, seed, STEP, rms=1.0, fade_s=0.02)
    padded = np.concatenate([np.zeros(rest), torque, np.zeros(rest)])
    assert period_samples(padded) == period


@pytest.mark.parametrize("torque", [np.zeros(1000), paper_plant.chirp(20.0, 0.5), np.arange(1000.0)])
def test_no_period_is_found_where_there_is_none(torque: np.ndarray) -> None:
    assert period_samples(torque) is None


def test_linear_plant_shows_noise_and_no_distortion() -> None:
    frf = bla()
    errors = np.abs(frf.response[0] - truth(frf)) / frf.standard_deviation[0]
    assert np.sqrt(np.mean(errors**2)) == pytest.approx(1, abs=0.35)
    d = frf.distortion
    assert d is not None
    for level, noise in ((d.odd, d.odd_noise), (d.even, d.even_noise)):
        assert np.sqrt(np.mean(level**2) / np.mean(noise**2)) == pytest.approx(1, abs=0.15)


def test_cubic_is_odd_distortion_and_counts_into_the_uncertainty() -> None:
    frf = bla(cubic=0.1, noise=0.001)
    d = frf.distortion
    assert d is not None
    assert np.mean(d.odd**2) > 100 * np.mean(d.odd_noise**2)
    assert np.mean(d.even**2) < 4 * np.mean(d.even_noise**2)
    assert np.median(frf.nonlinear / frf.standard_deviation) > 0.9
    # Around 1 N m rms a cubic of 0.1 adds about 3·0.1 of gain to the best linear approximation.
    assert np.abs(np.mean(frf.response[0] / truth(frf)) - 1.3) < 0.05


def test_square_is_even_distortion() -> None:
    d = bla(square=0.1, noise=0.001).distortion
    assert d is not None
    assert np.mean(d.even**2) > 100 * np.mean(d.even_noise**2)
    assert np.mean(d.odd**2) < 4 * np.mean(d.odd_noise**2)


def test_estimate_takes_the_periodic_method_for_a_multisine() -> None:
    frf = estimate([experiment(1), experiment(2)], from_hz=0.25, to_hz=25)
    assert frf.method.startswith("periodic, 2 realisations of 5 periods")


def test_equal_phases_are_repeats_and_not_realisations() -> None:
    frf = best_linear_approximation([experiment(1), experiment(1)], round(PERIOD_S / STEP), 0.25, 25)
    assert frf.method.startswith("periodic, 1 realisations of 10 periods")


def test_one_period_is_too_short() -> None:
    short = experiment(1)
    cut = Experiment("cut", STEP, short.input[:6000], short.outputs[:, :6000], OUTPUTS[:1])
    with pytest.raises(UnfitDataError, match="too short"):
        best_linear_approximation([cut], round(PERIOD_S / STEP), 0.25, 25)


def test_a_period_is_found_of_an_input_as_it_was_measured() -> None:
    """Single samples of a measured current are off by more than any two of the one asked for."""
    torque = stimuli.multisine(list(range(11, 60, 2)), 1.0, 14, 1, STEP, rms=10.0, fade_s=0.02)
    rng = np.random.default_rng(2)
    measured = torque + rng.normal(0.0, 0.1, len(torque))
    measured[rng.integers(0, len(torque), 20)] += 2.0
    assert period_samples(measured) == round(1.0 / STEP)
