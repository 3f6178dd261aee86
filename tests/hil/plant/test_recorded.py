"""Where a replay begins: as well as its first seconds tell, without hiding what a model lacks."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hil.core.channels import INPUT, OUTPUTS, TIME
from hil.core.model import EffectUse, Model
from hil.core.recording import Recording
from hil.plant import Start, replay, simulate
from hil.plant._recorded import beginning, settled
from hil.plant._replay import _shown_from

STEP_S = 1e-3
NOISE = {"motor_speed_rad_s": 0.5, "wheel_speed_rad_s": 0.05, "shaft_torque_nm": 3.0}
CHAIN = Model(
    "two_inertia",
    {
        "motor_inertia": 0.02,
        "gear_ratio": 10.0,
        "shaft_stiffness": 6000.0,
        "shaft_damping": 20.0,
        "vehicle_inertia": 300.0,
        "torque_delay": 0.02,
    },
)


def _torque(seconds: float, seed: int) -> np.ndarray:
    """Random levels of a tenth of a second, N m."""
    levels = np.random.default_rng(seed).normal(0.0, 20.0, round(10 * seconds))
    return np.repeat(levels, round(0.1 / STEP_S))


def _measured(seed: int, cut: int, model: Model = CHAIN) -> Recording:
    """A recording that begins in mid-motion, with noise; what was asked for before is not in it."""
    torque = _torque(12.0, seed)
    truth = simulate(model, torque, STEP_S, Start(100.0, 10.0))
    rng = np.random.default_rng(seed + 1)
    noisy = {name: truth[name][cut:] + rng.normal(0.0, NOISE[name], len(torque) - cut) for name in NOISE}
    time = np.arange(0.0, len(torque) - cut) * STEP_S
    return Recording({TIME: time, INPUT: torque[cut:], **noisy}, Path("cut.csv"))


@pytest.mark.parametrize("seed", range(4))
def test_a_replay_of_the_true_model_leaves_noise_alone(seed: int) -> None:
    recording = _measured(seed, cut=150)  # in the middle of a level, its dead time full of the same torque
    shown = replay(CHAIN, recording)
    for name, noise in NOISE.items():
        left = np.sqrt(np.mean((recording[name] - shown[name]) ** 2))
        assert left == pytest.approx(noise, rel=0.02), name


def test_a_start_does_not_hide_what_a_model_lacks() -> None:
    """A replay of the wrong inertia begins within the noise of the first samples."""
    recording = _measured(0, cut=150)
    wrong = CHAIN.with_parameters(vehicle_inertia=150.0, torque_delay=0.0)
    shown = replay(wrong, recording)
    read, error = beginning(recording["wheel_speed_rad_s"])
    assert abs(shown["wheel_speed_rad_s"][0] - read) <= 4.0 * error + 1e-9


def test_first_samples_without_noise_are_the_start() -> None:
    first = np.array([3.0, 1.0, 2.0, 0.0, 0.0])
    measured = np.tile(first[:3], (100, 1))
    assert np.array_equal(
        settled(first, np.zeros(5), np.zeros(5), measured, lambda at: measured + at[:, None, :3]), first
    )


def test_a_start_of_a_model_that_runs_away_is_found_without_overflow() -> None:
    """An inertia next to nothing shows 1e300 rad/s, and infinitely many after that."""
    first, measured = np.array([3.0, 1.0, 2.0, 0.0, 0.0]), np.zeros((100, 3))

    def show(at: np.ndarray) -> np.ndarray:
        shown = np.repeat(1e300 * at[:, None, :3], 100, axis=1)
        shown[:, 50:] = np.inf
        return shown

    assert np.isfinite(settled(first, np.array([0.1, 0.1, 0.1, 0.0, 0.0]), np.zeros(5), measured, show)).all()


def test_a_channel_that_was_not_recorded_has_no_beginning() -> None:
    assert np.isnan(beginning(np.full(30, np.nan))).all()


@pytest.mark.parametrize(
    "effects",
    [
        (),
        (EffectUse("coulomb_friction", {"torque_nm": 1.0}),),
        (EffectUse("motor_limits", {"peak_nm": 8.0, "power_w": 200.0}),),
        (EffectUse("sensor_quantization", {"channel": "motor_speed_rad_s", "step": 0.1}),),
    ],
)
def test_starts_are_looked_for_by_what_a_replay_shows_from_them(effects: tuple[EffectUse, ...]) -> None:
    """By the equations for many models at once, of which a replay itself is no part."""
    model = CHAIN.with_effects(*effects)
    torque = 10.0 * np.sin(0.02 * np.arange(500))
    starts = [Start(41.0, 5.3, 17.0, 0.0), Start(40.0, 4.0, 10.0, 0.0)]
    many = _shown_from(starts, model, torque, STEP_S, None, np.zeros((0, 2)))
    for start, shown in zip(starts, many, strict=True):
        alone = simulate(model, torque, STEP_S, start)
        for name, column in zip(OUTPUTS, shown.T, strict=True):
            most = np.max(np.abs(alone[name]))
            assert np.max(np.abs(column - alone[name])) < 2e-3 * most, name
