"""A chirp and a multisine of two-inertia chains, and problems of bases that are asked about them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt

from hil.analysis.missing_effects._noise import proven_noise
from hil.analysis.missing_effects._problem import Problem, problem_of
from hil.analysis.missing_effects._series import series_of
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
#: With a tyre.
THREE = NUMBERS | {
    "wheel_inertia": 4.0,
    "tyre_stiffness": 5000.0,
    "tyre_damping": 400.0,
    "vehicle_inertia": 350.0,
}
#: A rigid axle.
RIGID = {
    "motor_inertia": 0.024,
    "gear_ratio": 7.9,
    "vehicle_inertia": 300.0,
    "viscous_drag": 0.002,
    "torque_delay": 8.1e-3,
}
#: Two motors on a shaft, as on benches that identify one.
MOTORS = {
    "motor_inertia": 0.0048,
    "gear_ratio": 1.0,
    "shaft_stiffness": 553.0,
    "shaft_damping": 0.01,
    "vehicle_inertia": 0.0048,
    "torque_delay": 0.0,
}


def chirp(noise: float, *effects: EffectUse, axle: dict[str, float] = NUMBERS) -> Recording:
    """A chirp of a chain with effects, each channel with so much noise of its standard deviation."""
    time = np.arange(20_000, dtype=np.float64) * 1e-3
    torque = 40.0 * np.sin(2.0 * np.pi * (0.5 * time + 0.7 * time**2))
    kind = "three_inertia" if "wheel_inertia" in axle else "two_inertia"
    return driven(Model(kind, axle, effects=effects), torque, noise)


def driven(model: Model, torque: npt.NDArray[np.float64], noise: float) -> Recording:
    """What a model shows of a torque at 1 kHz, each channel with so much noise of its standard deviation."""
    time = np.arange(len(torque), dtype=np.float64) * 1e-3
    rng = np.random.default_rng(0)
    shown = {
        name: np.asarray(v + noise * np.std(v) * rng.normal(size=len(v)), dtype=np.float64)
        for name, v in simulate(model, torque, 1e-3).items()
    }
    return Recording({"time_s": time, "motor_torque_ref_nm": torque} | shown, Path("driven.csv"))


def chirp_problem(factor: float, *effects: EffectUse) -> Problem:
    """A chirp of a chain with effects; a base whose inertias and stiffness are off by a factor."""
    far = {
        name: value * (factor if name.endswith(("inertia", "stiffness")) else 1.0)
        for name, value in NUMBERS.items()
    }
    return problem_about(Model("two_inertia", far), chirp(0.005, *effects))


def multisine(*effects: EffectUse) -> Recording:
    """Speeds of two motors with effects in 14 periods of a multisine, 11 to 399 Hz, 1 % noise."""
    rate, rng = 2500.0, np.random.default_rng(1)
    time = np.arange(round(14 * rate)) / rate
    lines = np.arange(11, 400)
    phases = rng.uniform(0.0, 2.0 * np.pi, len(lines))
    torque = np.sin(2.0 * np.pi * time[:, None] * lines + phases).sum(axis=1)
    torque *= 3.0 / np.std(torque)
    channels = simulate(Model("two_inertia", MOTORS, effects=effects), torque, 1.0 / rate)
    speeds = {
        name: np.asarray(v + 0.01 * np.std(v) * rng.normal(size=len(v)), dtype=np.float64)
        for name, v in channels.items()
        if name.endswith("speed_rad_s")
    }
    return Recording({"time_s": time, "motor_torque_ref_nm": torque} | speeds, Path("multisine.csv"))


def multisine_problem(factor: float, *effects: EffectUse) -> Problem:
    """A multisine of two motors with effects; a base whose inertias are off by a factor."""
    far = {name: value * (factor if name.endswith("inertia") else 1.0) for name, value in MOTORS.items()}
    return problem_about(Model("two_inertia", far | {"shaft_stiffness": 500.0}), multisine(*effects))


def problem_about(model: Model, recording: Recording) -> Problem:
    """A base that is asked about a recording, whose noise is proven."""
    series = series_of(model, [recording])
    levels = proven_noise(series, {})
    return problem_of(model, series, levels)
