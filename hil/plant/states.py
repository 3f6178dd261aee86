"""The driveline's states, for every kernel. Wheel-side quantities are sums or means of both sides.

The linear ones stand first: they alone are the state of the linear system and of the kernel of many models.
Behind the wheel's angle stand what effects remember.
"""

from __future__ import annotations

from hil.plant.slots import ACTING, Table

STATES = Table()
_state = STATES.place

ROTOR_SPEED = _state("rotor_speed", "rad/s", "of the rotor in space")
TWIST = _state("twist", "rad", "of the shafts, wheel side")
WHEEL_SPEED = _state("wheel_speed", "rad/s", "of wheels and dyno rotors")
TYRE_TWIST = _state("tyre_twist", "rad", "of the tyre/road coupling")
VEHICLE_SPEED = _state("vehicle_speed", "rad/s", "of the vehicle, as a wheel that does not slip")
LAGGED = _state("lagged_torque", "N m", "that acts on the rotor behind the actuator's lag")
HOUSING_ANGLE = _state("housing_angle", "rad", "of the housing on its bushes")
HOUSING_SPEED = _state("housing_speed", "rad/s", "of the housing on its bushes")
LINEAR_STATES = len(STATES)

WHEEL_ANGLE = _state("wheel_angle", "rad", "that wheel orders follow")
MOVING = len(STATES)  # what moves by rates

#: Where among the memories that of each effect stands, for those that have one.
MEMORY = {effect.id: at for at, effect in enumerate(e for e in ACTING if e.memory is not None)}
for _effect in ACTING:
    if _effect.memory is not None:
        _state(f"{_effect.id}", _effect.memory.unit, _effect.memory.meaning)
ALL_STATES = len(STATES)

AT_REST = (0.0,) * MOVING
LINEAR_AT_REST = (0.0,) * LINEAR_STATES
NO_MEMORY = (0.0,) * max(1, ALL_STATES - MOVING)
