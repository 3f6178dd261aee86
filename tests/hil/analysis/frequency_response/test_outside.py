"""Recordings without segments: the way to the test speed and back is no answer to the input."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from scipy.signal import chirp

from hil.analysis.frequency_response import experiments_of
from hil.analysis.frequency_response._outside import split_by_motion
from hil.core.recording import Recording

Array = npt.NDArray[np.float64]

STEP_S = 0.001
INERTIA = 0.5  # kg m²


def chirped(lasts_s: float = 10.0) -> Array:
    """A chirp of 20 N m, 0.3 to 10 Hz."""
    time = np.arange(round(lasts_s / STEP_S)) * STEP_S
    return 20.0 * np.asarray(chirp(time, 0.3, lasts_s, 10.0, "logarithmic", phi=-90))


def recorded(torque: Array, foreign: Array) -> Recording:
    """A rigid axle in closed form; `foreign` is the torque of the bench."""
    speed = np.concatenate([[0.0], np.cumsum(torque + foreign)[:-1]]) * STEP_S / INERTIA
    time = np.arange(len(torque)) * STEP_S
    channels: dict[str, Array] = {
        "time_s": np.asarray(time, np.float64),
        "motor_torque_ref_nm": torque,
        "motor_speed_rad_s": speed,
    }
    return Recording(channels, Path("r.csv"))


def rest(lasts_s: float, torque: float = 0.0) -> Array:
    return np.full(round(lasts_s / STEP_S), torque)


def test_the_bench_takes_over_in_rests() -> None:
    torque = np.concatenate([rest(2.0), chirped(), rest(1.0), chirped(), rest(2.0)])
    foreign = np.concatenate([rest(2.0, 200.0), rest(21.0), rest(2.0, -200.0)])
    recording = recorded(torque, foreign)
    kept, left_out = split_by_motion(recording, "motor_torque_ref_nm")
    assert [round(one.start_s) for one in left_out] == [0, 12, 23]
    assert [(round(one.start_s), round(one.end_s)) for one in kept] == [(2, 12), (13, 23)]
    experiments = experiments_of(recording)
    assert len(experiments) == 2
    assert experiments[0].duration_s == pytest.approx(10.0, abs=0.01)
    assert "left out: 0 to 1.999 s, 12 to 13 s" in experiments[0].notes[-1]
    assert not experiments[1].notes


def test_a_coast_of_the_axle_alone_stays() -> None:
    torque = np.concatenate([rest(1.0), chirped(), rest(2.0)])
    assert split_by_motion(recorded(torque, 0.0 * torque), "motor_torque_ref_nm") == ([], [])


def test_steps_that_rest_nearly_always_are_one_experiment() -> None:
    torque = np.concatenate([rest(2.0, level) for level in (0.0, 20.0, -10.0, 5.0, 0.0)])
    foreign = np.concatenate([rest(2.0, 100.0), rest(8.0)])
    assert split_by_motion(recorded(torque, foreign), "motor_torque_ref_nm") == ([], [])


def test_a_random_binary_signal_is_one_experiment() -> None:
    rng = np.random.default_rng(1)
    torque = np.repeat(rng.choice([-20.0, 20.0], 200), 100)
    assert split_by_motion(recorded(torque, 0.0 * torque), "motor_torque_ref_nm") == ([], [])


def test_without_a_speed_or_with_gaps_nothing_is_cut() -> None:
    torque = np.concatenate([rest(2.0), chirped(), rest(2.0)])
    foreign = np.concatenate([rest(2.0, 200.0), rest(12.0)])
    recording = recorded(torque, foreign)
    assert split_by_motion(recording, "motor_torque_ref_nm")[1]
    recording.channels["motor_speed_rad_s"][5] = np.nan
    assert split_by_motion(recording, "motor_torque_ref_nm") == ([], [])
    del recording.channels["motor_speed_rad_s"]
    assert split_by_motion(recording, "motor_torque_ref_nm") == ([], [])
