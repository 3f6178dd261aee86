"""Channels that freeze for a while are refused; what stands still or is held is not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hil.analysis.diagnosis import examine
from hil.analysis.diagnosis.data.frozen import refuse_frozen
from hil.analysis.diagnosis.data.trace import trace_of
from hil.core.errors import BadInputError
from hil.core.model import EffectUse, Model, parameter_names
from hil.core.recording import Recording
from hil.plant import Start, simulate
from tests.hil.analysis import paper_plant
from tests.hil.analysis.diagnosis.hidden_cases import EFFECTS, draw
from tests.hil.analysis.diagnosis.reference_plant import BASE, CHANNELS, recordings

TORQUE = "motor_torque_ref_nm"
MOTOR, WHEEL, SHAFT = CHANNELS
MODEL = Model("three_inertia", dict(BASE))
LEVELS = (0.15, 0.02, 1.5)


def chirp(
    model: Model = MODEL,
    noise: float = 1.0,
    speed: float = 10.0,
    amplitude: float = 30.0,
    highest_hz: float = 30.0,
    seconds: float = 20.0,
) -> Recording:
    torque = paper_plant.chirp(seconds, 0.1, highest_hz, amplitude)
    start = Start(speed * model.parameters["gear_ratio"], speed, 0.0)
    seen = simulate(model, torque, 1e-3, start)
    rng = np.random.default_rng(0)
    count = len(torque)
    noisy = {
        c: seen[c] + noise * s * rng.standard_normal(count) for c, s in zip(CHANNELS, LEVELS, strict=True)
    }
    return Recording({"time_s": np.arange(count) / 1e3, TORQUE: torque, **noisy}, Path("chirp.csv"))


@pytest.mark.parametrize("channel", CHANNELS)
@pytest.mark.parametrize("noise", [0.0, 1.0])
@pytest.mark.parametrize("noise_as_frozen", [False, True])
@pytest.mark.parametrize("stretch", [slice(0, 8000), slice(1000, 9000), slice(1000, None)])
def test_a_channel_that_freezes_is_refused(
    channel: str, noise: float, noise_as_frozen: bool, stretch: slice
) -> None:
    recording = chirp(noise=noise, amplitude=100.0)
    values = recording.channels[channel].copy()
    held = values[stretch]
    level = LEVELS[CHANNELS.index(channel)] if noise_as_frozen else 0.0
    value = held[-1] if stretch.start == 0 else held[0]
    values[stretch] = value + noise * level * np.random.default_rng(1).standard_normal(len(held))
    recording.channels[channel] = values
    with pytest.raises(BadInputError, match=f"{channel} looks frozen") as caught:
        examine(MODEL, [recording])
    assert "chirp.csv" in caught.value.where


@pytest.mark.parametrize("noise", [0.0, 1.0])
def test_standstill_by_dry_friction_is_data(noise: float) -> None:
    stuck = MODEL.with_effects(EffectUse("coulomb_friction", {"torque_nm": 8.0}))
    torque = paper_plant.chirp(20.0, 0.1, 30.0, 10.0)
    seen = simulate(stuck, torque, 1e-3)
    rng = np.random.default_rng(0)
    noisy = {
        c: seen[c] + noise * s * rng.standard_normal(20000) for c, s in zip(CHANNELS, LEVELS, strict=True)
    }
    time = np.arange(20000) / 1e3
    assert examine(MODEL, [Recording({"time_s": time, TORQUE: torque, **noisy}, Path("r.csv"))])[0]


@pytest.mark.parametrize("step", [0.5, 1.0])
def test_a_rounded_wheel_speed_is_data(step: float) -> None:
    recording = chirp()
    recording.channels[WHEEL] = np.round(recording.channels[WHEEL] / step) * step
    assert examine(MODEL, [recording])[0]


@pytest.mark.parametrize("amplitude", [30.0, 100.0])
def test_a_wheel_that_a_dyno_holds_is_data(amplitude: float) -> None:
    parameters = {name: BASE[name] for name in parameter_names("two_inertia")}
    held = Model("two_inertia", {**parameters, "vehicle_inertia": 1e6})
    recording = chirp(held, amplitude=amplitude)
    refuse_frozen(trace_of(recording), np.array(LEVELS), held)
    assert examine(held, [recording])[0]


@pytest.mark.parametrize("vehicle_inertia", [300.0, 600.0])
@pytest.mark.parametrize("highest_hz", [20.0, 30.0, 50.0])
@pytest.mark.parametrize("noise", [2.0, 4.0])
@pytest.mark.parametrize("damping", [4.0, 10.0])
def test_the_still_wheel_of_a_heavy_car_is_data_as_the_motor_swings_at_its_resonance(
    vehicle_inertia: float, highest_hz: float, noise: float, damping: float
) -> None:
    parameters = {
        "motor_inertia": 0.021,
        "gear_ratio": 9.95,
        "shaft_stiffness": 6950.0,
        "shaft_damping": damping,
        "vehicle_inertia": vehicle_inertia,
        "torque_delay": 0.007,
    }
    heavy = Model("two_inertia", parameters)
    recording = chirp(heavy, noise=noise, speed=1.0, amplitude=100.0, highest_hz=highest_hz, seconds=40.0)
    assert examine(heavy, [recording])[0]


@pytest.mark.parametrize("effect", EFFECTS)
def test_no_effect_is_taken_for_a_frozen_channel(effect: str) -> None:
    truth, _ = draw((effect,), 1.0, 2)
    for recording in recordings(truth, 4, short=True):
        if all(np.all(np.isfinite(recording[c])) for c in CHANNELS):
            assert examine(MODEL, [recording])[0]


def test_a_wheel_that_rests_beside_a_drifting_motor_speed_is_data() -> None:
    recording = chirp(speed=0.0, amplitude=20.0)
    time = recording["time_s"]
    recording.channels[MOTOR] = recording[MOTOR] + 16.0 * np.sin(2 * np.pi * time / 50.0)
    assert examine(MODEL, [recording])[0]
