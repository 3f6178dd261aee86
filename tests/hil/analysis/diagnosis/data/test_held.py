"""Channels that are dead, clipped or frozen are refused; what stands still or is held is not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hil.analysis.diagnosis import examine
from hil.analysis.diagnosis.data.held import moves, refuse_held
from hil.analysis.diagnosis.thresholds import MOMENT_S
from hil.analysis.missing_effects import Series, proven_noise, series_of
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
    series = series_of(held, [recording])
    refuse_held(held, series, proven_noise(series, {}))
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


def one_series(**changed: np.ndarray) -> Series:
    recording = chirp()
    recording.channels.update(changed)
    return series_of(MODEL, [recording])[0]


def refused(*series: Series, beside: tuple[Series, ...] = ()) -> str:
    try:
        refuse_held(MODEL, list(series), proven_noise([*series, *beside], {}), beside)
    except BadInputError as error:
        return error.what
    return ""


def test_a_good_recording_is_not_refused() -> None:
    assert refused(one_series()) == ""


@pytest.mark.parametrize("channel", CHANNELS)
def test_a_channel_that_reads_one_value_as_the_others_move_is_dead(channel: str) -> None:
    assert (
        refused(one_series(**{channel: np.full(20_000, 3.0)}))
        == f"{channel} looks dead: it reads 3 throughout"
    )


@pytest.mark.parametrize("channel", CHANNELS)
def test_a_channel_that_ends_at_its_range_is_clipped(channel: str) -> None:
    values = chirp()[channel]
    top = float(np.median(values) + 0.5 * np.ptp(values) / 2)
    assert refused(one_series(**{channel: np.minimum(values, top)})).startswith(f"{channel} looks clipped at")


@pytest.mark.parametrize(("lasts_s", "frozen"), [(0.2 * MOMENT_S, False), (2.0 * MOMENT_S, True)])
def test_a_telegram_that_was_lost_is_data_and_noise_that_stops_is_not(lasts_s: float, frozen: bool) -> None:
    values, samples = chirp()[MOTOR].copy(), round(1e3 * lasts_s)
    values[5000 : 5000 + samples] = values[5000]
    assert bool(refused(one_series(**{MOTOR: values}))) is frozen


@pytest.mark.parametrize("push", [0.2, 4.0])
def test_a_speed_alone_may_stand_still_but_not_under_more_torque_than_moved_it(push: float) -> None:
    """Dry friction, or a rounding, holds what little torque does; more would move it again."""
    moving = chirp().without([WHEEL, SHAFT])
    still = {**moving.channels, TORQUE: push * moving[TORQUE], MOTOR: np.full(20_000, moving[MOTOR][0])}
    first, second = (series_of(MODEL, [one])[0] for one in (moving, Recording(still, Path("still.csv"))))
    assert bool(refused(first, second)) is (push > 1.0)
    assert bool(refused(second, beside=(first,))) is (push > 1.0)


def test_a_wheel_speed_in_steps_of_more_than_it_moves_is_data() -> None:
    rounded = np.round(chirp(amplitude=100.0, speed=20.0)[WHEEL] / 3.0) * 3.0
    moving = one_series(**{WHEEL: rounded})
    assert refused(one_series(**{WHEEL: np.full(20_000, 9.0)}), beside=(moving,)) == ""


def test_a_wheel_speed_of_two_levels_is_data() -> None:
    rounded = np.where(chirp()[WHEEL] > 10.0, 12.0, 0.0)
    assert len(np.unique(rounded)) == 2
    assert refused(one_series(**{WHEEL: rounded})) == ""


def test_what_moves_is_more_than_noise() -> None:
    series = one_series(**{WHEEL: np.random.default_rng(0).normal(0.0, 0.02, 20_000)})
    noise = proven_noise([series], {})
    assert [moves(series, column, noise) for column in range(3)] == [True, False, True]


@pytest.mark.parametrize(("share", "frozen"), [(0.01, False), (0.5, True)])
def test_a_servo_that_stands_still_at_one_step_of_its_speed_is_data(share: float, frozen: bool) -> None:
    """An encoder at rest reads the same again and again, if not just zero; at speed nothing does."""
    values = chirp(speed=0.0)[MOTOR].copy()
    values[5000:5800] = share * np.max(np.abs(values))
    assert bool(refused(one_series(**{MOTOR: values}))) is frozen
