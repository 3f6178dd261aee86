"""One millisecond of the simulated bench, compiled: sensors, RMCU, drives, plant."""

from __future__ import annotations

import math

from hil.core.runtime.compiled import compiled
from hil.plant import kernel as K
from hil.plant import sides as S
from hil.plant import slots as P
from hil.plant import states as X
from hil.plant.closed_loop import drive as D
from hil.plant.controller import memory as M
from hil.plant.controller.control import control
from hil.plant.sensors import DELAY, GAIN, LAG, OFFSET, STEP, between, lagged, reading, samples_late

# Columns of a row: what the bench's frames tell of one sample, and then what stands in the RMCU's memory
(
    MOTOR_SPEED,
    TORQUE_REF,
    TORQUE,
    DRIVING_REF,
    DRIVING_EST,
    SATURATED,
    STATE,
    FAULT,
    PARAMETERS_VALID,
    COUNTER,
    ALWAYS_ONE,
    VEHICLE_SPEED,
    WHEEL_LEFT,
    WHEEL_RIGHT,
    SHAFT_LEFT,
    SHAFT_RIGHT,
    LOAD_LEFT,
    LOAD_RIGHT,
    STATUS_LEFT,
    STATUS_RIGHT,
    FEEDFORWARD_TORQUE,
    FEEDBACK_TORQUE,
    WHEEL_REFERENCE,
    SLIP_INTEGRAL,
    SPEED_INTEGRAL,
    OBSERVED_FORCE,
    OBSERVER_TORQUE,
    OBSERVER_SPEED,
    FOLLOWED_REQUEST,
    TWIST_REFERENCE,
) = range(30)
COLUMNS = 30
SIGNS = (1.0, -1.0)  # left, right
SENSORS = 5  # motor speed, wheel left, wheel right, shaft left, shaft right
SENSOR_GAIN, SENSOR_OFFSET, SENSOR_STEP, SENSOR_DELAY = GAIN, OFFSET, STEP, DELAY

# Scalars of the world
SLEWED, WAS_COUPLED, SLIP, RADIUS, V_HAT, LAST_TORQUE, INITIAL_SPEED, DRIVE_INERTIA, LONGEST_STEP = range(9)
SCALARS = 9
HISTORY = 2048
PAST = HISTORY + 1  # what a sensor keeps: a ring of what it saw, and the truth of the sample before


@compiled
def _sense(value, noise, sensor, past, k, dt):  # type: ignore[no-untyped-def]
    """A sensor's reading from the ring of what it saw; never early, and late no longer than the ring."""
    seen = value
    if sensor[LAG] > 0.0 and k > 0:
        seen = lagged(past[(k - 1) % HISTORY], past[HISTORY], value, sensor[LAG], dt)
    past[k % HISTORY], past[HISTORY] = seen, value
    whole, part = samples_late(sensor, dt)
    if whole > HISTORY - 2:
        whole, part = HISTORY - 2, 0.0
    newer = past[max(k - whole, 0) % HISTORY]
    older = past[max(k - whole - 1, 0) % HISTORY]
    return reading(between(newer, older, part), noise, sensor)


@compiled
def _couple(x, drives, w):  # type: ignore[no-untyped-def]
    """Whether both drives simulate the vehicle; at the start the vehicle takes the wheel's speed."""
    coupled = drives[0, D.MODE] == D.VEHICLE and drives[1, D.MODE] == D.VEHICLE
    if coupled and w[WAS_COUPLED] == 0.0:
        speed = x[X.WHEEL_SPEED]
        wanted = w[INITIAL_SPEED] / w[RADIUS]
        if abs(wanted - speed) < 1.0:
            speed = wanted
        x[X.VEHICLE_SPEED] = speed
    for side in range(2):
        if drives[side, D.MODE] != D.SPEED:
            drives[side, D.RAMPED_SPEED] = x[X.WHEEL_SPEED]
            drives[side, D.INTEGRATOR] = 0.0
    w[WAS_COUPLED] = 1.0 if coupled else 0.0
    return coupled


@compiled
def tick(  # type: ignore[no-untyped-def]
    k, x, form, p, w, torques, fir, drives, sensors, past, noise, mode, request, code, status, row
):
    """Sample k: fill `row` with what is measured and commanded at t_k, then move to t_k+1.

    `x` is the state; as many of its numbers move as `form` is long. `p` is the packed model by value. `fir`
    holds the RMCU's arrays (numerators, denominators, filter states, gains, states).
    """
    b, a, z, gains, states = fir
    dt = gains[M.SAMPLE_TIME]
    coupled = _couple(x, drives, w)
    state, memories = K.as_state(x, form)
    apart, twisted, taken, more = S.differences(state, memories, p, coupled)
    for side in range(2):
        speed = x[X.WHEEL_SPEED] + SIGNS[side] * apart
        row[LOAD_LEFT + side] = D.load(drives[side], speed, 0.5 * w[DRIVE_INERTIA], dt)
    loads = S.loads(state, row[LOAD_LEFT], row[LOAD_RIGHT])
    truth = noise[SENSORS:]  # scratch room behind the noise
    outside = 0.0 if coupled else row[LOAD_LEFT] + row[LOAD_RIGHT]
    K.outputs(state, memories, p, w[SLEWED], coupled, outside, truth)
    if coupled:  # the drives play the vehicle: nothing else is at the wheels
        loads = S.loads(state, 0.0, 0.0)
        for side in range(2):
            row[LOAD_LEFT + side] = 0.5 * (truth[K.OUT_LOAD] + more) + SIGNS[side] * taken
    row[MOTOR_SPEED] = _sense(truth[K.OUT_MOTOR_SPEED], noise[0], sensors[0], past[0], k, dt)
    for side in range(2):
        row[WHEEL_LEFT + side] = _sense(
            truth[K.OUT_WHEEL_SPEED] + SIGNS[side] * apart,
            noise[1 + side],
            sensors[1 + side],
            past[1 + side],
            k,
            dt,
        )
        row[SHAFT_LEFT + side] = _sense(
            0.5 * truth[K.OUT_SHAFT_TORQUE] + SIGNS[side] * twisted,
            noise[3 + side],
            sensors[3 + side],
            past[3 + side],
            k,
            dt,
        )
    # V̂ reaches the RMCU in the dyno controller's frame, one sample late and with that frame's resolution.
    v_hat = w[V_HAT]
    w[V_HAT] = round((1.0 - w[SLIP]) * w[RADIUS] * x[X.VEHICLE_SPEED] * 1e5) * 1e-5
    row[VEHICLE_SPEED] = w[V_HAT]
    row[TORQUE] = truth[K.OUT_MOTOR_TORQUE]
    torque = control(b, a, z, gains, states, mode, request, v_hat, row[MOTOR_SPEED], w[LAST_TORQUE])
    w[LAST_TORQUE] = row[TORQUE]
    row[TORQUE_REF] = torque
    row[DRIVING_REF] = request if mode == M.DRIVING_FORCE else 0.0
    row[DRIVING_EST] = states[M.ESTIMATE] if mode == M.DRIVING_FORCE else 0.0
    row[SATURATED] = states[M.SATURATED]
    row[STATE] = code & 15
    row[FAULT] = (code >> 4) & 15
    row[PARAMETERS_VALID] = (code >> 8) & 1
    row[COUNTER] = k  # its bits in a frame let it begin again
    row[ALWAYS_ONE] = 1.0
    row[STATUS_LEFT] = status[0]
    row[STATUS_RIGHT] = status[1]
    row[FEEDFORWARD_TORQUE] = states[M.FEEDFORWARD_TORQUE]
    row[FEEDBACK_TORQUE] = states[M.FEEDBACK_TORQUE]
    row[WHEEL_REFERENCE] = states[M.WHEEL_REFERENCE]
    row[SLIP_INTEGRAL] = states[M.SLIP]
    row[SPEED_INTEGRAL] = states[M.INTEGRATOR]
    row[OBSERVED_FORCE] = states[M.ESTIMATE]
    row[OBSERVER_TORQUE] = z[M.OBSERVER_TORQUE, 0]
    row[OBSERVER_SPEED] = z[M.OBSERVER_SPEED, 0]
    row[FOLLOWED_REQUEST] = states[M.FOLLOWED]
    row[TWIST_REFERENCE] = states[M.TWIST]
    torques[k % HISTORY] = torque
    whole = math.floor(p[P.TORQUE_DELAY] / dt + 1e-9)
    late = max(0.0, p[P.TORQUE_DELAY] - whole * dt)
    if late < 1e-9 * dt:
        late = 0.0
    new = torques[(k - whole) % HISTORY]
    old = torques[(k - whole - 1) % HISTORY]
    state, memories, w[SLEWED] = K.sample(
        state, memories, p, w[SLEWED], old, new, late, dt, coupled, loads, w[LONGEST_STEP]
    )
    for i in range(len(state)):
        x[i] = state[i]
    for i in range(X.ALL_STATES - X.MOVING):
        x[len(state) + i] = memories[i]
