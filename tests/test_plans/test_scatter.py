"""Noise carried through a metric's definition, against what many seeds give."""

from __future__ import annotations

import numpy as np
import pytest

from test_plans.metrics import BandEnergyMotorSpeed, Peak
from test_plans.scatter import noise_of, standard_error
from tests.test_plans.signals import STEP, recording_of, second_order_step, time_axis

TIME = time_axis()


@pytest.mark.parametrize("size", [0.02, 0.5, 3.0])
def test_the_noise_of_a_channel_is_found_beside_its_motion(size: float) -> None:
    moving = second_order_step(TIME, 326.0, 0.16, 66.5)
    noise = np.random.default_rng(1).normal(0.0, size, len(TIME))
    assert noise_of(moving + noise) == pytest.approx(size, rel=0.05)
    assert noise_of(moving) < 0.02


def spread(metric, name: str, clean: np.ndarray, size: float) -> float:
    found = []
    for seed in range(40):
        noise = np.random.default_rng(100 + seed).normal(0.0, size, len(TIME))
        found.append(metric.compute(recording_of(TIME, **{name: clean + noise}), STEP))
    return float(np.std(found, ddof=1))


@pytest.mark.parametrize(
    ("metric", "name", "size"),
    [
        (Peak(channel="shaft_torque_nm"), "shaft_torque_nm", 0.5),
        (BandEnergyMotorSpeed(), "motor_speed_rad_s", 0.02),
    ],
    ids=["peak", "band energy"],
)
def test_the_standard_error_is_that_of_many_seeds(metric, name: str, size: float) -> None:
    clean = second_order_step(TIME, 326.0, 0.05, 66.5)
    noise = np.random.default_rng(2).normal(0.0, size, len(TIME))
    found = standard_error(metric, recording_of(TIME, **{name: clean + noise}), STEP)
    truth = spread(metric, name, clean, size)
    assert 0.4 * truth < found < 2.5 * truth


def test_without_noise_there_is_no_scatter() -> None:
    still = recording_of(TIME, shaft_torque_nm=np.zeros(len(TIME)))
    assert standard_error(Peak(channel="shaft_torque_nm"), still, STEP) == 0.0
