"""Channels out of step are found, told and put right, or the model is marked; on data of another formula.

The axle here is a state space of its own, executed by scipy.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from scipy.signal import chirp, lfilter, lsim

from hil.analysis.frequency_response import experiments_of
from hil.analysis.identification import Identification, identify
from hil.core.channels import INPUT, OUTPUTS, TIME
from hil.core.errors import BadInputError
from hil.core.recording import Recording
from tests.hil.analysis.identification.chains import THREE

Array = npt.NDArray[np.float64]
DELAY_S = THREE["torque_delay"]
AXLE = {name: value for name, value in THREE.items() if name != "torque_delay"}
NOISE = dict(zip(OUTPUTS, (0.05, 0.005, 1.0), strict=True))
MOTOR, WHEEL, SHAFT = OUTPUTS


def axle(seed: int, *, delay_s: float = DELAY_S, **changes: float) -> Recording:
    """A minute of a chirp: torque, motor speed, wheel speed and shaft torque with noise."""
    p = AXLE | changes
    ratio, k, d = p["gear_ratio"], p["shaft_stiffness"], p["shaft_damping"]
    kt, dt = p["tyre_stiffness"], p["tyre_damping"]
    jm, jw, jv = p["motor_inertia"], p["wheel_inertia"], p["vehicle_inertia"]
    # rotor, wheel, vehicle speed; twist of shaft, of tyre
    shaft = np.array([d / ratio, -d, 0.0, k, 0.0])
    tyre = np.array([0.0, dt, -dt, 0.0, kt])
    dynamics = np.array(
        [-shaft / ratio / jm, (shaft - tyre) / jw, tyre / jv, [1 / ratio, -1, 0, 0, 0], [0, 1, -1, 0, 0]]
    )
    shown = np.vstack([[1, 0, 0, 0, 0], [0, 1, 0, 0, 0], shaft])
    time_s = np.arange(60_000) / 1000.0
    torque = 15.0 * chirp(time_s, 0.2, 60.0, 30.0, "logarithmic", phi=-90)
    acting = np.interp(time_s - delay_s, time_s, torque, left=0.0)
    inputs = np.array([[1 / jm], [0.0], [0.0], [0.0], [0.0]])
    _, found, _ = lsim((dynamics, inputs, shown, np.zeros((3, 1))), acting, time_s)
    noise = np.random.default_rng(seed)
    outputs = {
        name: column + noise.normal(0.0, NOISE[name], len(time_s))
        for name, column in zip(OUTPUTS, found.T, strict=True)
    }
    return Recording({TIME: time_s, INPUT: torque, **outputs}, Path("axle.csv"))


def late(values: Array, milliseconds: float) -> Array:
    n = np.arange(float(len(values)))
    return np.interp(n - milliseconds, n, values)


def held(values: Array, milliseconds: int) -> Array:
    return values[np.arange(len(values)) // milliseconds * milliseconds]


def averaged(values: Array, milliseconds: int) -> Array:
    return np.asarray(lfilter(np.ones(milliseconds) / milliseconds, np.ones(1), values))


def drifting(values: Array, ppm: float) -> Array:
    n = np.arange(float(len(values)))
    return np.interp(n * (1 - ppm * 1e-6), n, values)


def with_channels(recording: Recording, change: Any, *names: str) -> Recording:
    channels = {name: np.array(recording[name]) for name in recording.channels}
    channels |= {name: change(channels[name]) for name in names}
    return Recording(channels, recording.source)


def identified(recording: Recording) -> Identification:
    return identify(experiments_of(recording))


@pytest.fixture(scope="module")
def recording() -> Recording:
    return axle(1)


def assert_is_the_axle(found: Identification, within: float = 0.02) -> None:
    assert found.chain is not None
    parameters = found.chain.best.model.parameters
    off = {name: parameters[name] / value - 1 for name, value in AXLE.items()}
    assert {name: value for name, value in off.items() if abs(value) > within} == {}
    assert found.physical is not None
    assert found.physical.doubt == ""


def test_an_axle_whose_channels_are_in_step_is_left_alone(recording: Recording) -> None:
    found = identified(recording)
    assert_is_the_axle(found)
    assert not [note for note in found.notes if "corrected" in note]


@pytest.mark.parametrize(
    ("change", "names", "said"),
    [
        (lambda x: late(x, 5), [MOTOR], "'motor_speed_rad_s' comes 5 ±"),
        (lambda x: late(x, 15), [WHEEL, SHAFT], "'wheel_speed_rad_s' comes 15 ±"),
        (lambda x: held(x, 10), [MOTOR], "is averaged or held over 10 ±"),
        (lambda x: averaged(x, 10), [SHAFT], "is averaged or held over 10 ±"),
    ],
    ids=["motor late", "dynos late", "motor held", "torque averaged"],
)
def test_what_is_out_of_step_is_told_and_put_right(
    recording: Recording, change: Any, names: list[str], said: str
) -> None:
    found = identified(with_channels(recording, change, *names))
    notes = [note for note in found.doubts if "corrected" in note]
    assert any(said in note.replace("9.9", "10").replace("10.1", "10") for note in notes), notes
    assert len(notes) == len(names)
    assert_is_the_axle(found)


def test_a_dead_time_of_several_periods_is_found_as_long_as_it_is() -> None:
    """155 ms are 4.6 periods of the highest frequency."""
    found = identified(axle(1, delay_s=0.155))
    assert found.orders.best.fit.modes.delay_s == pytest.approx(0.155, abs=1e-3)
    assert_is_the_axle(found)


def test_the_inverters_lag_is_no_channels(recording: Recording) -> None:
    """All outputs late and smoothed alike: the model is marked, no channel blamed."""
    lagged = with_channels(recording, lambda x: lfilter([0.2], [1.0, -0.8], x), *OUTPUTS)
    found = identified(lagged)
    assert not [note for note in found.notes if "corrected" in note]
    assert found.physical is not None
    assert "the chain misses the measured responses" in found.physical.doubt
    assert "standard_errors" not in found.physical.meta


@pytest.mark.parametrize("seed", range(200))
def test_no_drawn_axle_is_off_unmarked(seed: int) -> None:
    """Parameters within 2 % or 3 standard errors, or the model marked, or the data refused."""
    rng = np.random.default_rng(seed)
    names = [[MOTOR], [WHEEL], [SHAFT], [WHEEL, SHAFT]][rng.integers(4)]
    changes = {
        name: value * np.exp(rng.uniform(-0.4, 0.4)) for name, value in AXLE.items() if name != "gear_ratio"
    }
    kind = int(rng.integers(4))
    late_ms, ppm, width_ms = rng.uniform(0, 30), rng.uniform(0, 200), int(rng.integers(2, 21))
    change = [
        lambda x: late(x, late_ms),
        lambda x: drifting(x, ppm),
        lambda x: held(x, width_ms),
        lambda x: averaged(x, width_ms),
    ][kind]
    try:
        found = identified(with_channels(axle(seed, **changes), change, *names))
    except BadInputError:
        return
    assert found.physical is not None
    assert found.chain is not None
    if found.physical.doubt:
        return
    parameters, errors = found.chain.best.model.parameters, found.chain.best.standard_errors
    for name, value in (AXLE | changes).items():
        off, in_errors = parameters[name] / value - 1, (parameters[name] - value) / errors[name]
        assert abs(off) < 0.02 or abs(in_errors) < 3, (name, off, in_errors, kind, names)
