"""A chirp of a two-inertia chain, and the problem of a base that is asked about it."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from hil.analysis.missing_effects._noise import proven_noise
from hil.analysis.missing_effects._problem import Problem, problem_of
from hil.analysis.missing_effects._series import series_of
from hil.analysis.missing_effects._spectrum import white
from hil.core.model import EffectUse, Model
from hil.core.recording import Recording
from hil.plant import simulate

NUMBERS = {
    "motor_inertia": 0.02,
    "gear_ratio": 8.0,
    "shaft_stiffness": 6000.0,
    "shaft_damping": 20.0,
    "vehicle_inertia": 200.0,
    "torque_delay": 0.004,
}


def chirp(noise: float, *effects: EffectUse) -> Recording:
    """A chirp of a chain with effects, each channel with so much noise of its standard deviation."""
    time = np.arange(20_000, dtype=np.float64) * 1e-3
    torque = 40.0 * np.sin(2.0 * np.pi * (0.5 * time + 0.7 * time**2))
    channels = simulate(Model("two_inertia", NUMBERS, effects=effects), torque, 1e-3)
    rng = np.random.default_rng(0)
    shown = {
        name: np.asarray(v + noise * np.std(v) * rng.normal(size=len(v)), dtype=np.float64)
        for name, v in channels.items()
    }
    return Recording({"time_s": time, "motor_torque_ref_nm": torque} | shown, Path("chirp.csv"))


def chirp_problem(factor: float, *effects: EffectUse) -> Problem:
    """A chirp of a chain with effects; a base whose inertias and stiffness are off by a factor."""
    far = {
        name: value * (factor if name.endswith(("inertia", "stiffness")) else 1.0)
        for name, value in NUMBERS.items()
    }
    model = Model("two_inertia", far)
    series = series_of(model, [chirp(0.005, *effects)])
    levels = proven_noise(series, {})
    return problem_of(model, series, levels, white(levels, series[0].rate_hz))
