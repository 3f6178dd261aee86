"""Numbers and linear effects of a chain by its responses, from far bases."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hil.analysis.missing_effects._linear import structures
from hil.analysis.missing_effects._noise import proven_noise
from hil.analysis.missing_effects._problem import Problem, problem_of
from hil.analysis.missing_effects._series import series_of
from hil.analysis.missing_effects._spectrum import white
from hil.core.model import EffectUse, Model
from hil.core.recording import Recording
from hil.plant import simulate

_NUMBERS = {
    "motor_inertia": 0.02,
    "gear_ratio": 8.0,
    "shaft_stiffness": 6000.0,
    "shaft_damping": 20.0,
    "vehicle_inertia": 200.0,
    "torque_delay": 0.004,
}


def _problem(factor: float, *effects: EffectUse) -> Problem:
    """A chirp of a two-inertia chain; a base whose inertias and stiffness are off by a factor."""
    time = np.arange(20_000, dtype=np.float64) * 1e-3
    torque = 40.0 * np.sin(2.0 * np.pi * (0.5 * time + 0.7 * time**2))
    channels = simulate(Model("two_inertia", _NUMBERS, effects=effects), torque, 1e-3)
    rng = np.random.default_rng(0)
    shown = {
        name: np.asarray(v + 0.005 * np.std(v) * rng.normal(size=len(v)), dtype=np.float64)
        for name, v in channels.items()
    }
    whole = {"time_s": time, "motor_torque_ref_nm": torque} | shown
    far = {
        name: value * (factor if name.endswith(("inertia", "stiffness")) else 1.0)
        for name, value in _NUMBERS.items()
    }
    model = Model("two_inertia", far)
    series = series_of(model, [Recording(whole, Path("chirp.csv"))])
    noise = proven_noise(series, {})
    return problem_of(model, series, noise, white(noise, series[0].rate_hz))


@pytest.mark.parametrize("factor", [1.0, 0.4, 2.5])
def test_numbers_of_a_chain_come_out_the_same_from_any_base(factor: float) -> None:
    found = structures(_problem(factor))[0].numbers
    for name in ("motor_inertia", "shaft_stiffness", "vehicle_inertia"):
        assert found[name] == pytest.approx(_NUMBERS[name], rel=0.02)


def test_a_lag_behind_a_far_base_shows_in_the_responses() -> None:
    lag = EffectUse("actuator_lag", {"time_constant_s": 0.008})
    best = structures(_problem(2.5, lag))[1]
    assert best.names == ("actuator_lag",)
    assert float(best.terms[0].values["time_constant_s"]) == pytest.approx(0.008, rel=0.1)


def test_a_rigid_model_has_no_responses_to_read() -> None:
    numbers = dict.fromkeys(("motor_inertia", "gear_ratio", "vehicle_inertia", "viscous_drag"), 1.0)
    model = Model("rigid", numbers | {"torque_delay": 0.0})
    time = np.arange(2000) * 1e-3
    shown = {"time_s": time, "motor_torque_ref_nm": np.sin(time), "motor_speed_rad_s": time}
    series = series_of(model, [Recording(shown, Path("rigid.csv"))])
    assert structures(problem_of(model, series, np.ones(3), white(np.ones(3), 250.0))) == []
