"""A request that was read too seldom: taken as smooth between its samples."""

import dataclasses

import numpy as np
import pytest
from scipy import signal

from hil.analysis.diagnosis.data.request import is_stepped, smooth
from tests.hil.analysis.diagnosis.one_recording import one_trace


@pytest.mark.parametrize("hz", [1.0, 10.0, 20.0])
def test_held_it_shakes_a_driveline_as_the_smooth_one_does(hz: float) -> None:
    """Against what a sine does to a resonance at 8 Hz, which is known exactly, read every 10 ms."""
    step, own = 0.01, 2.0 * np.pi * 8.0
    time = np.arange(0.0, 20.0, step)
    trace = dataclasses.replace(one_trace(), torque=np.sin(2 * np.pi * hz * time), dt=step)
    driveline = signal.tf2ss([own**2], [1.0, 0.2 * own, own**2])
    sampled = signal.cont2discrete(driveline, step, "zoh")
    held = signal.dlsim(sampled, smooth(trace).torque)[1][:, 0]
    turning = 2 * np.pi * hz
    response = own**2 / (own**2 - turning**2 + 0.2j * own * turning)
    exact = np.imag(response * np.exp(2j * np.pi * hz * time))
    inside = slice(len(time) // 2, -100)
    assert np.std((held - exact)[inside]) < 0.04 * np.std(exact[inside])
    late = signal.dlsim(sampled, trace.torque)[1][:, 0]
    assert np.std((late - exact)[inside]) > (0.02 if hz < 5.0 else 0.2) * np.std(exact[inside])


def test_a_constant_stays_as_it_is() -> None:
    trace = dataclasses.replace(one_trace(), torque=np.full(1000, 7.0), dt=0.01)
    assert smooth(trace).torque == pytest.approx(np.full(1000, 7.0))


def test_steps_are_told_from_what_changes_all_the_time() -> None:
    time = np.arange(0.0, 10.0, 0.01)
    steps, chirp = np.sign(np.sin(time)), np.sin(time**2)
    assert is_stepped(dataclasses.replace(one_trace(), torque=steps))
    assert not is_stepped(dataclasses.replace(one_trace(), torque=chirp))
