"""Orders of turning: found in the misfit, wherever that is large."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hil.analysis.missing_effects._fit import linearised, point_at, with_better_starts
from hil.analysis.missing_effects._hypothesis import Hypothesis
from hil.analysis.missing_effects._noise import proven_noise
from hil.analysis.missing_effects._orders import bins_of, by_order, fineness, over_angle
from hil.analysis.missing_effects._problem import problem_of
from hil.analysis.missing_effects._screen import promises
from hil.analysis.missing_effects._series import series_of
from hil.core.model import EffectUse, Model
from hil.core.recording import Recording
from hil.plant import simulate

_CHAIN = Model(
    "two_inertia",
    {
        "motor_inertia": 0.02,
        "gear_ratio": 8.0,
        "shaft_stiffness": 6000.0,
        "shaft_damping": 20.0,
        "vehicle_inertia": 100.0,
        "torque_delay": 0.0,
    },
)


@pytest.mark.parametrize("order", [1.0, 3.4])
def test_an_order_whose_misfit_grows_towards_a_resonance_promises_most(order: float) -> None:
    """A run up from standstill: the ripple gets faster and larger until the recording ends."""
    ripple = EffectUse("wheel_order_disturbance", {"order": order, "amplitude_nm": 20.0, "phase_rad": 0.4})
    hidden = Model("two_inertia", dict(_CHAIN.parameters), (ripple,))
    time = np.arange(24_000) * 1e-3
    torque = 20.0 + 5.0 * np.sin(2.0 * np.pi * 0.5 * time)
    channels = simulate(hidden, torque, 1e-3)
    rng = np.random.default_rng(0)
    shown = {name: one + rng.normal(0.0, 0.01 * np.std(one), len(one)) for name, one in channels.items()}
    measured = Recording({"time_s": time, "motor_torque_ref_nm": torque} | shown, Path("up.csv"))
    series = series_of(_CHAIN, [measured])
    noise = proven_noise(series, {})
    problem = problem_of(_CHAIN, series, noise)
    point = with_better_starts(problem, point_at(problem, Hypothesis(_CHAIN, _CHAIN.parameters)))
    problem = problem.weighed_by(point.powers(problem).spectrum(noise))
    promised = promises(problem, linearised(problem, point))
    best = max(promised, key=lambda one: one.gain)
    assert best.label == "wheel_order_disturbance"
    assert float(best.use.values["order"]) == pytest.approx(order, abs=0.02)


def test_orders_lie_closer_the_further_a_recording_turns() -> None:
    """A quarter of a turn over the whole: a ripple between two of them would lose its phase."""
    assert fineness(10.0) == 0.02
    assert fineness(100.0) * 100.0 == 0.25


def test_two_sums_over_an_angle_are_transformed_as_each_alone() -> None:
    rng = np.random.default_rng(3)
    angle, values = rng.uniform(0.0, 300.0, 500), rng.normal(size=(2, 500))
    fine, count = 0.02, 211
    sums = np.array([np.bincount(bins_of(angle, fine, count), one, 4 * count) for one in values])
    alone = [over_angle(one, angle, fine, count) for one in values]
    assert np.allclose(by_order(sums, count), alone, rtol=0.0, atol=1e-9)
