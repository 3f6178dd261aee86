"""The driveline's states, for every kernel. Wheel-side quantities are sums or means of both sides.

The linear ones stand first: they alone are the state of the linear system and of the kernel of many models.
"""

from __future__ import annotations

from hil.plant._table import Table

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
SLIP = _state("slip", "rad", "twist of the hysteretic path")
SEAT = _state("seat", "rad", "where the shafts stand in the gap")
ALL_STATES = len(STATES)

AT_REST = (0.0,) * ALL_STATES
LINEAR_AT_REST = (0.0,) * LINEAR_STATES
