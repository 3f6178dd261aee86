"""Recordings made ready: blocks, angles, notes, and from which octave on a periodic torque says anything."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from hil.analysis.missing_effects._series import FIT_RATE_HZ, Series, block_means, series_of
from hil.core.channels import INPUT, MOTOR_ANGLE, OUTPUTS, TIME, WHEEL_ANGLE
from hil.core.errors import BadInputError
from hil.core.model import Model, TransferFunction
from hil.core.recording import Recording

_MASS = Model(
    "rigid",
    {
        "motor_inertia": 0.3,
        "gear_ratio": 1.0,
        "vehicle_inertia": 0.2,
        "viscous_drag": 0.5,
        "torque_delay": 0.0,
    },
)


def _series(torque: np.ndarray) -> Series:
    time = np.arange(0.0, len(torque)) * 1e-3
    speed = np.cumsum(torque) * 1e-3 / 0.5
    recording = Recording({TIME: time, INPUT: torque, "motor_speed_rad_s": speed}, Path("one.csv"))
    return series_of(_MASS, [recording])[0]


def _multisine(seconds: int) -> np.ndarray:
    """Lines from 11 to 60 Hz that repeat every second, measured with a little noise."""
    rng = np.random.default_rng(0)
    time = np.arange(1000 * seconds) * 1e-3
    lines = [np.sin(2.0 * np.pi * hz * time + rng.uniform(0.0, 6.3)) for hz in range(11, 60, 2)]
    return np.asarray(np.sum(lines, axis=0) + 0.14 + rng.normal(0.0, 0.05, len(time)))


def test_below_the_lines_of_a_multisine_nothing_counts() -> None:
    assert _series(_multisine(12)).lowest_hz == pytest.approx(8.0)


def test_of_a_torque_that_does_not_repeat_all_octaves_count() -> None:
    steps = np.repeat(np.random.default_rng(1).normal(0.0, 5.0, 12), 1000)
    assert _series(steps).lowest_hz == 0.0


def test_a_torque_that_repeats_from_the_lowest_octave_on_counts_whole() -> None:
    square = np.tile(np.repeat([5.0, -5.0], 2000), 4)
    assert _series(square).lowest_hz == 0.0


def _recorded(**channels: np.ndarray) -> Recording:
    time = 1e-3 * np.arange(4000, dtype=float)
    torque = 5.0 * np.sin(20.0 * time)
    speed = np.cumsum(torque) * 2e-3
    return Recording({TIME: time, INPUT: torque, OUTPUTS[0]: speed, **channels}, Path("one.csv"))


def test_blocks_are_means_at_the_rate_of_fits() -> None:
    (one,) = series_of(_MASS, [_recorded()])
    assert one.rate_hz == pytest.approx(FIT_RATE_HZ)
    assert one.measured[3, 0] == pytest.approx(one.samples[12:16, 0].mean())
    assert block_means(np.arange(10.0)[:, None], 4)[:, 0] == pytest.approx([1.5, 5.5])


def test_jittered_stamps_are_put_on_an_even_grid_and_noted() -> None:
    recording = _recorded()
    jitter = np.random.default_rng(2).uniform(-2e-4, 2e-4, 4000)
    (one,) = series_of(_MASS, [_recorded(**{TIME: recording[TIME] + jitter})])
    assert one.dt == pytest.approx(1e-3, rel=1e-3)
    assert one.even
    assert one.notes[0].startswith("time stamps jitter and readings keep a clock: taken to be 1 ms")
    assert one.source == "one.csv"


@pytest.mark.parametrize(
    ("every", "count", "words"),
    [(30, 4000, "has 134 samples"), (1, 120, "has 120 samples")],
)
def test_too_little_is_refused_with_what_is_needed(every: int, count: int, words: str) -> None:
    channels = {name: values[:count:every] for name, values in _recorded().channels.items()}
    with pytest.raises(BadInputError, match=words):
        series_of(_MASS, [Recording(channels, Path("one.csv"))])


def test_a_slow_recording_is_refused() -> None:
    time = 0.03 * np.arange(400, dtype=float)
    slow = {TIME: time, INPUT: np.sin(time), OUTPUTS[0]: np.cos(time)}
    with pytest.raises(BadInputError, match="too slow for a driveline"):
        series_of(_MASS, [Recording(slow, Path("one.csv"))])


def test_a_channel_with_nearly_the_right_name_is_noted() -> None:
    recording = _recorded(wheel_speed=np.ones(4000))
    assert series_of(_MASS, [recording])[0].notes == (
        "has no wheel_speed_rad_s, and 'wheel_speed' is not used: if it is that, rename it",
    )


def test_an_angle_stands_for_a_speed_and_is_noted() -> None:
    recording = _recorded()
    speed = recording.channels.pop(OUTPUTS[0])
    recording.channels[MOTOR_ANGLE] = np.cumsum(speed) * 1e-3
    (one,) = series_of(_MASS, [recording])
    assert one.notes == ("motor_speed_rad_s is what motor_angle_rad turns by within 4 ms",)
    assert one.samples[100:-100, 0] == pytest.approx(speed[100:-100], abs=0.05 * np.ptp(speed))


def test_outputs_without_a_function_are_not_compared() -> None:
    function = {OUTPUTS[0]: TransferFunction((1.0,), (0.5, 0.0))}
    model = Model("transfer_function", transfer_functions=function)
    (one,) = series_of(model, [_recorded(**{OUTPUTS[2]: np.ones(4000)})])
    assert one.has.tolist() == [True, False, False]
    assert any(OUTPUTS[2] in note for note in one.notes)
    for name in (OUTPUTS[1], WHEEL_ANGLE):
        lacking = Recording(
            {**_recorded().without([OUTPUTS[0]]).channels, name: np.ones(4000)}, Path("a.csv")
        )
        with pytest.raises(BadInputError, match="no function for any"):
            series_of(model, [lacking])


def _every(count: int) -> Recording:
    whole = _recorded()
    return replace(whole, channels={name: values[::count] for name, values in whole.channels.items()})


def test_recordings_of_other_rates_keep_their_samples_where_means_over_the_same_time_can_be_made() -> None:
    fine, coarse = _every(1), _every(3)
    for order in ((fine, coarse), (coarse, fine)):
        both = series_of(_MASS, order)
        assert [one.dt for one in both] == pytest.approx([1e-3 if one is fine else 3e-3 for one in order])
        assert [one.rate_hz for one in both] == pytest.approx([1.0 / 3e-3] * 2)
        assert not any("another rate" in note for one in both for note in one.notes)


def test_recordings_of_other_rates_come_on_the_grid_of_the_coarsest() -> None:
    fine, coarse = _every(2), _every(3)
    for order in ((fine, coarse), (coarse, fine)):
        both = series_of(_MASS, order)
        assert [one.dt for one in both] == pytest.approx([3e-3, 3e-3])
        assert {one.rate_hz for one in both} == {both[0].rate_hz}
        noted = [any(note.startswith("sampled at another rate") for note in one.notes) for one in both]
        assert noted == [one is fine for one in order]
    (held,) = series_of(_MASS, [fine], period_s=3e-3)
    assert held.dt == 3e-3
    impulse = float(np.sum(fine[INPUT]) * 2e-3)
    assert float(np.sum(held.torque) * held.dt) == pytest.approx(
        impulse, abs=0.01 * np.max(np.abs(fine[INPUT]))
    )
