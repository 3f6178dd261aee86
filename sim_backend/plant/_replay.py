"""Replays a torque through a model: what `hil simulate` and every comparison with data use."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from hil.core.channels import INPUT, TIME
from hil.core.model import EffectUse, Model
from hil.core.recording import Recording
from sim_backend.plant import _kernel, _slots
from sim_backend.plant._sensors import measured
from sim_backend.plant._transfer_function import respond

Array = npt.NDArray[np.float64]

LONGEST_STEP_S = 1e-4
_UNEVEN_SHARE = 0.01
_START_SAMPLES = 20


@dataclass(frozen=True)
class Start:
    """Where a replay begins: motor and wheel speed in rad/s, shaft torque in N m (wheel side)."""

    motor_speed_rad_s: float = 0.0
    wheel_speed_rad_s: float = 0.0
    shaft_torque_nm: float = 0.0


def simulate(
    model: Model,
    torque_ref_nm: Array,
    sample_time_s: float,
    start: Start | None = None,
    longest_step_s: float = LONGEST_STEP_S,
) -> dict[str, Array]:
    """Channels of `model` for a torque request held for `sample_time_s` from sample to sample.

    Args:
        torque_ref_nm: shape (n,), N m; its first value has acted since long before.
        start: initial speeds and shaft torque; standstill when left out.

    Returns:
        motor_torque_nm, motor_speed_rad_s, wheel_speed_rad_s and shaft_torque_nm, each of shape (n,)
        (a transfer-function model gives those it has functions for).
    """
    start = start or Start()
    torque = np.ascontiguousarray(torque_ref_nm, dtype=float)
    if model.kind == "transfer_function":
        channels = _functions(model, torque, sample_time_s, start, longest_step_s)
    else:
        parameters = _slots.pack(model)
        out = _kernel.empty_output(len(torque))
        begin = np.array([start.motor_speed_rad_s, start.wheel_speed_rad_s, start.shaft_torque_nm])
        _kernel.run(torque, sample_time_s, parameters, begin, longest_step_s, out)
        channels = {
            "motor_torque_nm": out[:, _kernel.OUT_MOTOR_TORQUE].copy(),
            "motor_speed_rad_s": out[:, _kernel.OUT_MOTOR_SPEED].copy(),
            "wheel_speed_rad_s": out[:, _kernel.OUT_WHEEL_SPEED].copy(),
            "shaft_torque_nm": out[:, _kernel.OUT_SHAFT_TORQUE].copy(),
        }
    return measured(model, channels, sample_time_s)


def replay(model: Model, recording: Recording) -> Recording:
    """`model` driven by a recording's torque request from its initial speeds, at its time stamps.

    Uneven time stamps are resampled (input held, outputs interpolated); `notes` says so.
    """
    time = recording.time_s
    dt = recording.sample_time_s
    torque = recording[INPUT]
    notes = []
    even = np.max(np.abs(np.diff(time) - dt)) <= _UNEVEN_SHARE * dt
    grid = time
    if not even:
        grid = time[0] + dt * np.arange(int(np.ceil((time[-1] - time[0]) / dt)) + 1)
        torque = torque[np.clip(np.searchsorted(time, grid + 1e-9 * dt, side="right") - 1, 0, len(time) - 1)]
        notes.append(f"time stamps are uneven: simulated every {dt * 1e3:g} ms, interpolated back")
    else:
        dt = float((time[-1] - time[0]) / (len(time) - 1))
    channels = simulate(model, torque, dt, start_of(recording))
    if not even:
        channels = {name: np.interp(time, grid, values) for name, values in channels.items()}
    return Recording({TIME: time, INPUT: recording[INPUT], **channels}, recording.source, notes=notes)


def start_of(recording: Recording) -> Start:
    """Initial condition: the mean of the first samples while the torque request has not changed yet."""
    torque = recording[INPUT]
    changes = np.flatnonzero(torque[:_START_SAMPLES] != torque[0])
    count = int(changes[0]) if changes.size else min(_START_SAMPLES, len(torque))

    def first(name: str) -> float:
        return float(np.mean(recording[name][:count])) if name in recording else np.nan

    motor, wheel, shaft = (first(n) for n in ("motor_speed_rad_s", "wheel_speed_rad_s", "shaft_torque_nm"))
    return Start(
        0.0 if np.isnan(motor) else motor,
        0.0 if np.isnan(wheel) else wheel,
        0.0 if np.isnan(shaft) else shaft,
    )


def _functions(
    model: Model, torque: Array, dt: float, start: Start, longest_step_s: float
) -> dict[str, Array]:
    acting = torque
    path = tuple(use for use in model.effects if use.id.startswith(("dead_time", "actuator", "torque_")))
    if path:
        acting = _torque_path(path, torque, dt, longest_step_s)
    begin = {
        "motor_speed_rad_s": start.motor_speed_rad_s,
        "wheel_speed_rad_s": start.wheel_speed_rad_s,
        "shaft_torque_nm": 0.0,
    }
    channels = {
        name: respond(function, acting, dt, begin[name])
        for name, function in model.transfer_functions.items()
    }
    return {"motor_torque_nm": acting, **channels}


def _torque_path(effects: tuple[EffectUse, ...], torque: Array, dt: float, longest_step_s: float) -> Array:
    """Acting torque of the effects in the torque path, through the kernel's own equations."""
    carrier = Model(
        "rigid",
        {
            "motor_inertia": 1.0,
            "gear_ratio": 1.0,
            "vehicle_inertia": 1.0,
            "viscous_drag": 0.0,
            "torque_delay": 0.0,
        },
        effects,
    )
    return simulate(carrier, torque, dt, None, longest_step_s)["motor_torque_nm"]
