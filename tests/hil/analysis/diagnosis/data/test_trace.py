"""A recording on even times, averaged to blocks."""

import dataclasses

import numpy as np
import pytest

from hil.analysis.diagnosis.data.thresholds import FIT_RATE_HZ
from hil.analysis.diagnosis.data.trace import blocks, trace_of
from hil.core.errors import BadInputError
from tests.hil.analysis.diagnosis.one_recording import MODEL, one_trace, recorded


def test_blocks_are_means_at_the_rate_of_fits() -> None:
    trace = one_trace()
    assert trace.dt * trace.block == pytest.approx(1.0 / FIT_RATE_HZ)
    assert trace.measured[3] == pytest.approx(trace.samples[12:16].mean(axis=0))


def test_what_does_not_fill_a_block_is_left_out() -> None:
    assert blocks(np.arange(10.0)[:, None], 4)[:, 0] == pytest.approx([1.5, 5.5])


def test_jittered_stamps_are_put_on_an_even_grid_and_noted() -> None:
    one = recorded()
    time = one.time_s + np.random.default_rng(2).uniform(-2e-4, 2e-4, len(one.time_s))
    found = trace_of(dataclasses.replace(one, channels={**one.channels, "time_s": time}))
    assert found.dt == pytest.approx(1e-3, rel=1e-3)
    assert "uneven" in found.notes[0]
    assert np.array_equal(found.samples[:, 0], one["motor_speed_rad_s"])


def test_angles_are_speeds_integrated_through_the_ratio() -> None:
    trace = one_trace()
    angles = trace.angles(MODEL.parameters["gear_ratio"])
    assert angles[0] == pytest.approx([0.0, 0.0])
    turned = np.trapezoid(trace.samples[:, 1], dx=trace.dt)
    assert angles[-1, 0] == pytest.approx(turned)


def test_too_slow_a_recording_is_refused() -> None:
    one = recorded(seconds=8.0)
    slow = {name: values[::30] for name, values in one.channels.items()}
    with pytest.raises(BadInputError, match="too slow for a driveline"):
        trace_of(dataclasses.replace(one, channels=slow))


def test_a_channel_with_nearly_the_right_name_is_told() -> None:
    recording = recorded()
    recording.channels["motor_speed"] = recording.channels.pop("motor_speed_rad_s")
    assert trace_of(recording).notes == (
        "has no motor_speed_rad_s, and 'motor_speed' is not used: if it is that, rename it",
    )
    recording.channels["motor_torque_nm"] = recording.channels.pop("motor_speed")
    assert trace_of(recording).notes == ()


def test_an_angle_stands_for_a_speed_and_is_noted() -> None:
    recording = recorded()
    speed = recording.channels.pop("motor_speed_rad_s")
    recording.channels["motor_angle_rad"] = np.cumsum(speed) * recording.sample_time_s
    found = trace_of(recording)
    assert found.notes == ("motor_speed_rad_s is what motor_angle_rad turns by within 4 ms",)
    assert found.samples[100:-100, 0] == pytest.approx(speed[100:-100], abs=0.05 * np.ptp(speed))
