"""What the RMCU makes of requests, compiled: many of them may come between two looks at its bus.

The state is two arrays, so that Python and compiled code change the same one.
"""

from __future__ import annotations

from hil.core.can.frames import crc8_of
from hil.core.can.signals import bits_at, number_at
from hil.core.runtime.compiled import compiled
from hil.plant.controller.memory import DRIVING_FORCE, FAULT, OFF, TORQUE

REQUEST_TIMEOUT_S = 0.05
COUNTER_VALUES = 16
# Whole numbers of the state. COUNTER: of the newest request, -1 before the first; VALID: the parameters are.
MODE, CAUSE, VALID, COUNTER, WHOLE_NUMBERS = range(5)
# Real numbers: torque asked for (N m), and when request and vehicle speed came last (s)
REQUEST, REQUEST_S, VEHICLE_S, REAL_NUMBERS = range(4)
# Causes of a fault
NONE, TIMEOUT, WRONG_COUNTER, WRONG_CRC, VEHICLE_SPEED, PARAMETERS = range(6)
# Signals of the request frame, rows of `places`
CRC_PLACE, COUNTER_PLACE, MODE_PLACE, TORQUE_PLACE = range(4)


@compiled
def take_request(payload, time_s, frame_id, places, scale, offset, whole, real):  # type: ignore[no-untyped-def]
    """A request frame that came at `time_s`; its torque is raw * `scale` + `offset`."""
    if bits_at(payload, places[CRC_PLACE]) != crc8_of(frame_id, payload):
        if whole[CAUSE] == NONE:
            whole[CAUSE] = WRONG_CRC
        return
    counter = bits_at(payload, places[COUNTER_PLACE])
    expected = (whole[COUNTER] + 1) % COUNTER_VALUES
    first = whole[COUNTER] < 0
    whole[COUNTER] = counter
    if not first and counter != expected:
        if whole[CAUSE] == NONE:
            whole[CAUSE] = WRONG_COUNTER
        return
    real[REQUEST_S] = time_s
    _change_mode(bits_at(payload, places[MODE_PLACE]), time_s, whole, real)
    asked = whole[MODE] == TORQUE or whole[MODE] == DRIVING_FORCE
    real[REQUEST] = number_at(payload, places[TORQUE_PLACE]) * scale + offset if asked else 0.0


@compiled
def _change_mode(wanted, time_s, whole, real):  # type: ignore[no-untyped-def]
    if wanted == OFF:
        whole[MODE], whole[CAUSE] = OFF, NONE
    elif whole[MODE] == FAULT or wanted > DRIVING_FORCE:
        return  # a fault stays until the bench has asked for 'off'
    elif wanted == DRIVING_FORCE and not whole[VALID]:
        _fail(PARAMETERS, whole, real)
    elif wanted == DRIVING_FORCE and time_s - real[VEHICLE_S] > REQUEST_TIMEOUT_S:
        _fail(VEHICLE_SPEED, whole, real)
    else:
        whole[MODE] = wanted
        if whole[CAUSE] == WRONG_CRC or whole[CAUSE] == WRONG_COUNTER:
            whole[CAUSE] = NONE


@compiled
def _fail(cause, whole, real):  # type: ignore[no-untyped-def]
    whole[MODE], whole[CAUSE], real[REQUEST] = FAULT, cause, 0.0


@compiled
def supervise(time_s, whole, real):  # type: ignore[no-untyped-def]
    """Drop to fault, torque zero, when what the mode needs has become old."""
    if whole[MODE] == OFF or whole[MODE] == FAULT:
        return
    if time_s - real[REQUEST_S] > REQUEST_TIMEOUT_S:
        _fail(TIMEOUT, whole, real)
    elif whole[MODE] == DRIVING_FORCE and time_s - real[VEHICLE_S] > REQUEST_TIMEOUT_S:
        _fail(VEHICLE_SPEED, whole, real)


@compiled
def follow(  # type: ignore[no-untyped-def]
    first, tick_s, samples, payloads, frame_id, places, scale, offset, whole, real, modes, requests, codes
):
    """What the control law is asked in sample `first` and those that follow it, one for each of `modes`.

    `payloads`: request frames, each with the sample before which it came, in order. The vehicle speed comes
    in every sample. State, cause and validity stand in one code: state | cause << 4 | valid << 8.
    """
    next_ = 0
    for k in range(len(modes)):
        time_s = (first + k) * tick_s
        while next_ < len(samples) and samples[next_] <= first + k:
            take_request(payloads[next_], time_s, frame_id, places, scale, offset, whole, real)
            next_ += 1
        real[VEHICLE_S] = time_s
        supervise(time_s, whole, real)
        modes[k], requests[k] = whole[MODE], real[REQUEST]
        codes[k] = whole[MODE] | whole[CAUSE] << 4 | whole[VALID] << 8
