"""Replays a torque through a model: what `hil simulate` and every comparison with data use."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from hil.core.channels import ANGLES, INPUT, OUTPUTS, TIME, WHEEL_ANGLE
from hil.core.effects import EFFECTS, Stage
from hil.core.errors import BadInputError
from hil.core.model import EffectUse, Model
from hil.core.recording import Recording
from hil.plant import _angles, _recorded, kernel, slots
from hil.plant._batch_simulation import simulate_many
from hil.plant._functions import respond_many
from hil.plant._regulated import turning_load
from hil.plant._stability import LONGEST_STEP_S, refuse_divergence, refuse_too_stiff
from hil.plant._stamps import UNEVEN_SHARE, at_true_times, even_times, held_over, jittered
from hil.plant.sensors import GAIN, OFFSET, measured, sensor_of
from hil.plant.sides import LUMPED, form_of

Array = npt.NDArray[np.float64]

_RESTING_SHARE = 0.05
_LATE = {"dead_time": ("extra_delay_s",), "actuator_lag": ("time_constant_s",)}
_SLOW_HZ = 1e-3


@dataclass(frozen=True)
class Start:
    """Where a replay begins: motor and wheel speed in rad/s, shaft torque in N m (wheel side).

    `motor_torque_nm` has acted before the first sample; None: the first sample's torque. A vehicle behind a
    tyre may be faster than the wheel, as in mid-motion, by `vehicle_ahead_rad_s`, and the tyre twisted by
    `tyre_twist_rad` more than the shaft torque holds.
    """

    motor_speed_rad_s: float = 0.0
    wheel_speed_rad_s: float = 0.0
    shaft_torque_nm: float = 0.0
    motor_torque_nm: float | None = None
    wheel_angle_rad: float = 0.0
    vehicle_ahead_rad_s: float = 0.0
    tyre_twist_rad: float = 0.0


def simulate(
    model: Model,
    torque_ref_nm: Array,
    sample_time_s: float,
    start: Start | None = None,
    longest_step_s: float = LONGEST_STEP_S,
    load_nm: Array | None = None,
) -> dict[str, Array]:
    """Channels of `model` for a torque request held for `sample_time_s` from sample to sample.

    Args:
        torque_ref_nm: shape (n,), N m.
        start: initial speeds and shaft torque; standstill when left out.
        load_nm: shape (n,), N m: brakes the wheels beside the model's own vehicle; none when left out.

    Returns:
        motor_torque_nm, motor_speed_rad_s, wheel_speed_rad_s and shaft_torque_nm, each of shape (n,)
        (a transfer-function model gives those it has functions for). With separate wheels also speed and
        torque of each side.
    """
    start = start or Start()
    torque = np.ascontiguousarray(torque_ref_nm, dtype=float)
    if model.kind == "transfer_function":
        channels = _functions(model, torque, sample_time_s, start, longest_step_s)
    else:
        parameters = slots.pack(model)
        beside = form_of(model)[len(LUMPED) :]
        out = kernel.empty_output(len(torque), sides=bool(beside))
        before = torque[0] if start.motor_torque_nm is None else start.motor_torque_nm
        begin = np.array(
            [
                start.motor_speed_rad_s,
                start.wheel_speed_rad_s,
                start.shaft_torque_nm,
                before,
                start.wheel_angle_rad,
                start.vehicle_ahead_rad_s,
                start.tyre_twist_rad,
            ]
        )
        load = np.zeros(len(torque)) if load_nm is None else np.ascontiguousarray(load_nm, dtype=float)
        kernel.run(torque, load, True, sample_time_s, parameters, begin, longest_step_s, out, beside)
        channels = {
            "motor_torque_nm": out[:, kernel.OUT_MOTOR_TORQUE].copy(),
            "motor_speed_rad_s": out[:, kernel.OUT_MOTOR_SPEED].copy(),
            "wheel_speed_rad_s": out[:, kernel.OUT_WHEEL_SPEED].copy(),
            "shaft_torque_nm": out[:, kernel.OUT_SHAFT_TORQUE].copy(),
        }
        if beside:
            channels |= _sides(out)
    return measured(model, channels, sample_time_s)


def _sides(out: Array) -> dict[str, Array]:
    """Channels of each side: half of what the shafts carry together, and half of what they differ by."""
    speed, torque = out[:, kernel.OUT_WHEEL_SPEED], 0.5 * out[:, kernel.OUT_SHAFT_TORQUE]
    apart, twisted = out[:, kernel.OUT_WHEEL_APART], out[:, kernel.OUT_SHAFT_APART]
    return {
        "wheel_speed_left_rad_s": speed + apart,
        "wheel_speed_right_rad_s": speed - apart,
        "shaft_torque_left_nm": torque + twisted,
        "shaft_torque_right_nm": torque - twisted,
    }


def replay(model: Model, recording: Recording) -> Recording:
    """`model` driven by a recording's torque request from its initial speeds, at its time stamps.

    It begins at what the first samples show, within their noise where the next seconds suit best. Ripples
    follow the angle that recorded speeds turn through. Where the model has a `load_input`, that channel
    brakes its wheels, or they turn as it says. Where an angle was recorded in place of a speed, both are
    given, the angle from its first reading on. Uneven time stamps are resampled (input by means, load and
    outputs interpolated); `notes` says so.

    Raises:
        BadInputError: the simulation diverges, or would; or the model's load was not recorded.
    """
    refuse_too_stiff(model)
    stamps, recording = recording.time_s, at_true_times(recording)
    time = recording.time_s
    dt = recording.sample_time_s
    torque = recording[INPUT]
    load = load_of(model, recording)
    notes = [jittered(dt)] if time is not stamps else []
    even = np.max(np.abs(np.diff(time) - dt)) <= UNEVEN_SHARE * dt
    grid = time
    if not even:
        grid, dt = even_times(time)
        torque = held_over(grid, dt, time, torque)
        load = None if load is None else np.interp(grid, time, load)
        notes.append(f"time stamps are uneven: simulated every {dt * 1e3:g} ms, interpolated back")
    else:
        dt = float((time[-1] - time[0]) / (len(time) - 1))
    recorded, of_angle = _on_grid(recording, grid), _angles.by_angle(recording)
    angle = float(recording[WHEEL_ANGLE][0]) if WHEEL_ANGLE in recording else 0.0
    channels = replayed(model, torque, dt, recorded, load, angle, of_angle)
    refuse_divergence(channels, grid, model)
    for name in (one for one, turns in zip(OUTPUTS, of_angle, strict=True) if turns and one in channels):
        first = float(_angles.angle_at(recording, ANGLES[name], grid[:1])[0])
        channels[ANGLES[name]] = _angles.angle_of(channels[name], dt, first)
    if not even:
        channels = {name: np.interp(time, grid, values) for name, values in channels.items()}
    inputs = {name: recording[name] for name in (INPUT, model.load_input) if name in recording}
    return Recording({TIME: stamps, **inputs, **channels}, recording.source, notes=notes)


def _along(
    model: Model, torque: Array, dt: float, start: Start, recorded: Array, load: Array | None
) -> dict[str, Array]:
    """Outputs of a model whose ripples follow recorded angles; none where no speed was recorded."""
    ratio = gear_ratio_of(model)
    if not np.isfinite(recorded[0, :2]).any() or ratio is None or form_of(model)[len(LUMPED) :]:
        return {}
    angles = _angles.turned(recorded, dt, ratio, start.wheel_angle_rad)
    shown = _shown_from([start], model, torque, dt, load, angles)[0]
    return {name: np.ascontiguousarray(shown[:, column]) for column, name in enumerate(OUTPUTS)}


def _shown_from(
    starts: Sequence[Start], model: Model, torque: Array, dt: float, load: Array | None, angles: Array
) -> Array:
    """Outputs of a model from several starts, which have the same torque before: starts x n x 3.

    By the equations for many models at once, but for those of a model that these do not have.
    """
    if form_of(model)[len(LUMPED) :]:
        each = [simulate(model, torque, dt, start, load_nm=load) for start in starts]
        return np.stack([np.column_stack([shown[name] for name in OUTPUTS]) for shown in each])
    begins = np.array([
        (one.motor_speed_rad_s, one.wheel_speed_rad_s, one.shaft_torque_nm,
         one.vehicle_ahead_rad_s, one.tyre_twist_rad)
        for one in starts
    ])  # fmt: skip
    sensors = np.stack([sensor_of(model, name) for name in OUTPUTS])
    sets = [np.repeat(one[None], len(starts), axis=0) for one in (slots.pack(model), sensors)]
    before, functions = starts[0].motor_torque_nm, model.transfer_functions
    return simulate_many(sets[0], torque, dt, begins, sets[1], 1, angles, load, functions, before)


def replayed(
    model: Model,
    torque_nm: Array,
    dt: float,
    recorded: Array,
    load_nm: Array | None = None,
    wheel_angle_rad: float = 0.0,
    of_angle: _angles.Flags = _angles.SPEEDS,
) -> dict[str, Array]:
    """What `replay` simulates, of arrays: channels of shape (n,).

    Args:
        torque_nm: shape (n,), held for `dt` seconds each.
        recorded: n x 3, in the order of `OUTPUTS`; NaN where a channel was not recorded.
        load_nm: shape (n,), brakes the wheels.
        wheel_angle_rad: at the first sample.
        of_angle: (3,), which speeds of `recorded` are those of an angle (`speed_of`).
    """
    start = settled_start(model, torque_nm, dt, recorded, load_nm, wheel_angle_rad, of_angle)
    channels = simulate(model, torque_nm, dt, start, load_nm=load_nm)
    if any(EFFECTS[use.id].law.follows is not None for use in model.effects):
        channels |= _along(model, torque_nm, dt, start, recorded, load_nm)
    return channels


def load_of(model: Model, recording: Recording) -> Array | None:
    """The recorded torque in N m that brakes a model's wheels; None for a model that takes none.

    Of wheels that turn as recorded it is the torque that has them do so (`_regulated`).

    Raises:
        BadInputError: the recording does not have it.
    """
    if not model.load_input:
        return None
    if slots.is_regulated(model):
        return turning_load(model, recording)
    if model.load_input not in recording:
        raise BadInputError(
            f"has no channel {model.load_input}, and the model takes it as its load",
            where=str(recording.source),
            fix="record it, or take load_input out of the model file, which then has to hold the vehicle",
        )
    return recording[model.load_input]


def _rests(model: Model, shaft_torque_nm: float, torque_nm: float) -> bool:
    """Whether the shafts hold next to nothing of the first torque: then none has acted before it."""
    gear_ratio = model.parameters.get("gear_ratio", 1.0)
    return abs(shaft_torque_nm) < _RESTING_SHARE * gear_ratio * abs(torque_nm)


def _on_grid(recording: Recording, grid: Array) -> Array:
    """The outputs at the even times of a grid, n x 3; NaN where neither they nor an angle were recorded."""

    def column(name: str, turns: bool) -> Array:
        if turns:
            return _angles.speed_of(_angles.angle_at(recording, ANGLES[name], grid), float(grid[1] - grid[0]))
        if name not in recording:
            return np.full(len(grid), np.nan)
        return np.interp(grid, recording.time_s, recording[name])

    each = zip(OUTPUTS, _angles.by_angle(recording).tolist(), strict=True)
    return np.column_stack([column(name, turns) for name, turns in each])


def settled_start(
    model: Model,
    torque_nm: Array,
    dt: float,
    measured: Array,
    load_nm: Array | None = None,
    wheel_angle_rad: float = 0.0,
    of_angle: _angles.Flags = _angles.SPEEDS,
) -> Start:
    """Where a replay begins: at what first samples show, within their noise where the next seconds suit best.

    Args:
        torque_nm: shape (n,), held for `dt` seconds each.
        measured: n x 3, in the order of `OUTPUTS`; NaN where a channel was not recorded.
        load_nm: shape (n,), brakes the wheels.
        of_angle: (3,), which of the speeds are those of an angle.
    """
    count = min(len(torque_nm), round(_recorded.SECONDS / dt))
    torque, measured = torque_nm[:count], measured[:count]
    read, errors = (np.array(one) for one in zip(*map(_recorded.beginning, measured.T), strict=True))
    sensors = np.stack([sensor_of(model, name) for name in OUTPUTS])
    gain = np.where(sensors[:, GAIN] == 0.0, 1.0, sensors[:, GAIN])  # a channel that shows nothing
    read, errors = (read - sensors[:, OFFSET]) / gain, errors / np.abs(gain)
    ratio = gear_ratio_of(model)
    if ratio:
        followed = np.array([ratio, 1.0 / ratio, np.nan])
        read = np.where(np.isfinite(read), read, followed * read[[1, 0, 2]])
        errors = np.where(np.isfinite(errors), errors, followed * errors[[1, 0, 2]])
    read, errors = np.nan_to_num(read), np.nan_to_num(errors)
    moves = np.abs(measured[min(_angles.half_window(dt), count - 1)] - measured[0])
    errors = errors + np.where(of_angle, np.nan_to_num(moves), 0.0)  # what first readings of an angle turn by
    rests = _rests(model, float(read[2]), float(torque[0]))
    stands = np.all(np.abs(read[:2]) <= errors[:2])
    unread = np.zeros(2) if stands else _behind_a_tyre(model, torque, measured)
    read, errors = np.append(read, np.zeros(2)), np.append(errors, unread)

    load = None if load_nm is None else load_nm[:count]
    angles = np.zeros((0, 2))
    if ratio is not None and np.isfinite(measured[0, :2]).any():
        angles = _angles.turned(measured, dt, ratio, wheel_angle_rad)

    def from_states(at: Array) -> Start:
        motor, wheel, shaft, ahead, twist = at.tolist()
        return Start(motor, wheel, shaft, 0.0 if rests else None, wheel_angle_rad, ahead, twist)

    def show(states: Array) -> Array:
        shown = _shown_from([from_states(at) for at in states], model, torque, dt, load, angles)
        return np.stack([_angles.as_read(one, of_angle, dt) for one in shown])

    return from_states(_recorded.settled(read, errors, _unrecorded(model, torque, dt), measured, show))


def _behind_a_tyre(model: Model, torque_nm: Array, measured: Array) -> Array:
    """How far ahead of the wheel a vehicle may be (rad/s), and a tyre be twisted (rad): nobody reads them.

    By what the largest torque moves wheel and tyre; (2,), zero without a tyre.
    """
    if model.kind == "transfer_function" or (chain := slots.chain_numbers(model)).kind != slots.THREE_INERTIA:
        return np.zeros(2)
    shaft = measured[:, 2] if np.isfinite(measured[0, 2]) else torque_nm * chain.gear_ratio
    holds = max(chain.tyre_damping, math.sqrt(chain.tyre_stiffness * chain.wheel_inertia))
    return float(np.max(np.abs(shaft))) / np.array([holds, chain.tyre_stiffness])


def _unrecorded(model: Model, torque_nm: Array, dt: float) -> Array:
    """Change of a start, (5,), by what was asked for before the first sample and acts after it.

    It was no larger than what is asked for in the same time after it.
    """
    if model.kind == "transfer_function":
        return np.zeros(5)
    delay_s = model.parameters.get("torque_delay", 0.0)
    for use in model.effects:
        delay_s += sum(float(use.values[name]) for name in _LATE.get(use.id, ()))
    largest = float(np.max(np.abs(torque_nm[: 1 + round(delay_s / dt)])))
    return np.array([largest * delay_s / model.parameters["motor_inertia"], 0.0, 0.0, 0.0, 0.0])


def gear_ratio_of(model: Model) -> float | None:
    """Motor over wheel speed of slow motion; None where a model's functions do not have both."""
    if "gear_ratio" in model.parameters:
        return model.parameters["gear_ratio"]
    both = [model.transfer_functions.get(name) for name in OUTPUTS[:2]]
    if None in both:
        return None
    motor, wheel = (abs(complex(f.response(np.array(_SLOW_HZ)))) for f in both if f is not None)
    return motor / wheel if wheel > 0.0 else None


def _functions(
    model: Model, torque: Array, dt: float, start: Start, longest_step_s: float
) -> dict[str, Array]:
    acting = torque
    path = tuple(use for use in model.effects if EFFECTS[use.id].stage is Stage.TORQUE_PATH)
    if path:
        acting = _torque_path(path, torque, dt, longest_step_s)
    begin = np.array([[start.motor_speed_rad_s, start.wheel_speed_rad_s, start.shaft_torque_nm]])
    sensors = np.stack([sensor_of(model.with_effects(), name) for name in OUTPUTS])[None]  # they come later
    shown = respond_many(model.transfer_functions, slots.pack(model)[None], torque, dt, begin, sensors, 1)[0]
    channels = {
        name: np.ascontiguousarray(shown[:, column])
        for column, name in enumerate(OUTPUTS)
        if name in model.transfer_functions
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
