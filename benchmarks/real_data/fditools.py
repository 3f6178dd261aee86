"""Two motors on a shaft, driven by multisines (Motor Bench of FdiTools, W. Ohnishi et al.; MIT licence).

Each of two recordings is there twice: with the encoders' angles, and with speeds that the drive computes,
which its own low pass makes late. Currents in A stand for N m: the authors give no torque constant, and with
1 N m/A inertias and stiffness of the shaft keep their ratios.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from benchmarks.real_data.measured import Array, DataSet, Measured, matlab
from hil.core.channels import INPUT, MOTOR_ANGLE, OUTPUTS, TIME, WHEEL_ANGLE
from hil.core.model import Model
from hil.core.recording import Recording

_RATE_HZ = 2500.0
_HELD_FROM_S = 14.0  # of 20 s; the multisine repeats every second
#: What brakes the two motors: no model of two inertias has it, and what of it is measured is not known.
_FRICTION = ("coulomb_friction", "viscous_drag", "load_coulomb_friction", "load_viscous_drag")
_START = {
    "motor_inertia": 0.005,
    "gear_ratio": 1.0,
    "shaft_stiffness": 500.0,
    "shaft_damping": 0.05,
    "vehicle_inertia": 0.005,
    "torque_delay": 0.0,
}


def _recording(path: Path, torque_nm: Array, motion: dict[str, Array]) -> Recording:
    time_s = np.arange(len(torque_nm)) / _RATE_HZ
    return Recording({TIME: time_s, INPUT: torque_nm, **motion}, path)


def _split(whole: Recording) -> Measured:
    fit, held = whole.between(0.0, _HELD_FROM_S), whole.between(_HELD_FROM_S, float(whole.time_s[-1]))
    held.source = whole.source.with_name(f"end of {whole.source.name}")
    return Measured({"round numbers": Model("two_inertia", dict(_START))}, [fit], [held])


def _by_encoders(path: Path) -> Measured:
    """Angles as the encoders give them; the load's counts the other way."""
    data = matlab(path, ("iq_adx", "theta_mx", "theta_my"))
    current, motor, load = (data[name].ravel() for name in ("iq_adx", "theta_mx", "theta_my"))
    return _split(_recording(path, current, {MOTOR_ANGLE: motor, WHEEL_ANGLE: -load}))


def _by_drive(path: Path) -> Measured:
    """Speeds as the drive gives them."""
    data = matlab(path, ("iq_adx", "omega_max", "omega_may"))
    current, motor, load = (data[name].ravel() for name in ("iq_adx", "omega_max", "omega_may"))
    return _split(_recording(path, current, dict(zip(OUTPUTS[:2], (motor, -load), strict=True))))


def _numbers_of(_: Path, model: Model) -> str:
    """What a model says of the shaft and the rotors, and how late it is."""
    numbers, late = model.parameters, {"actuator_lag": "time_constant_s", "dead_time": "extra_delay_s"}
    lag_s = [float(use.values[late[use.id]]) for use in model.effects if use.id in late]
    inertias = f"{numbers['motor_inertia']:.5f} and {numbers['vehicle_inertia']:.5f} kg m2"
    lags = "".join(f", lag {1e3 * one:.2f} ms" for one in lag_s)
    return f"{numbers['shaft_stiffness']:.1f} N m/rad, {inertias}{lags}"


def _data_set(name: str, letter: str, expected: str, *, drive: bool) -> DataSet:
    file = f"MultisineType{letter}.mat"
    read = _by_drive if drive else _by_encoders
    hidden = ("actuator_lag",) if drive else ()
    return DataSet(
        name,
        (file,),
        expected,
        lambda directory: read(directory / file),
        "fditools",
        hidden,
        _FRICTION,
        _numbers_of,
    )


_NUMBERS = "0.0048 and 0.0048 kg m2, 552 to 554 N m/rad (own fit of the responses)"
FDITOOLS = (
    _data_set("fditools_a", "A", f"unknown or a friction; {_NUMBERS}", drive=False),
    _data_set("fditools_b", "B", f"unknown or a friction; {_NUMBERS}", drive=False),
    _data_set("fditools_a_drive", "A", f"equal lags of both speeds of 7.8 ms; {_NUMBERS}", drive=True),
    _data_set("fditools_b_drive", "B", f"equal lags of both speeds of 7.8 ms; {_NUMBERS}", drive=True),
)
