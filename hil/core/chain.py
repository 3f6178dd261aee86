"""The linear driveline in numbers, by the names that model files, laws of effects and kernels share.

Rotor - gear - half shafts - wheel and dyno rotor - tyre and road - vehicle; the housing may turn on its
bushes. Wheel-side quantities are sums of both sides.
"""

from __future__ import annotations

from typing import NamedTuple

RIGID, TWO_INERTIA, THREE_INERTIA = 0.0, 1.0, 2.0
#: Kinds of model files that are a chain.
KINDS = {"rigid": RIGID, "two_inertia": TWO_INERTIA, "three_inertia": THREE_INERTIA}
WHEEL_RADIUS_M = 0.33  # where no one says another


class Chain(NamedTuple):
    """Numbers of a chain in SI units. What a chain does not have is zero."""

    kind: float = RIGID
    motor_inertia: float = 0.0
    gear_ratio: float = 1.0
    shaft_stiffness: float = 0.0
    shaft_damping: float = 0.0
    wheel_inertia: float = 0.0
    tyre_stiffness: float = 0.0
    tyre_damping: float = 0.0
    vehicle_inertia: float = 0.0
    torque_delay: float = 0.0
    torque_lag: float = 0.0
    viscous_drag: float = 0.0
    housing_inertia: float = 0.0
    mount_stiffness: float = 0.0
    mount_damping: float = 0.0
    wheel_radius_m: float = WHEEL_RADIUS_M


#: Unit and meaning of each.
MEANINGS: dict[str, tuple[str, str]] = {
    "kind": ("1", "which chain: RIGID, TWO_INERTIA or THREE_INERTIA"),
    "motor_inertia": ("kg m²", "of the rotor"),
    "gear_ratio": ("1", "motor speed over wheel speed"),
    "shaft_stiffness": ("N m/rad", "of both shafts, wheel side"),
    "shaft_damping": ("N m s/rad", "of both shafts, wheel side"),
    "wheel_inertia": ("kg m²", "of wheels and dyno rotors"),
    "tyre_stiffness": ("N m/rad", "of the tyre/road coupling"),
    "tyre_damping": ("N m s/rad", "of the tyre/road coupling"),
    "vehicle_inertia": ("kg m²", "of the vehicle, or of all that is not the rotor"),
    "torque_delay": ("s", "dead time of the torque path"),
    "torque_lag": ("s", "of the acting torque behind the requested"),
    "viscous_drag": ("N m s/rad", "over rotor speed"),
    "housing_inertia": ("kg m²", "of the housing; 0: it stands still"),
    "mount_stiffness": ("N m/rad", "of the bushes"),
    "mount_damping": ("N m s/rad", "of the bushes"),
    "wheel_radius_m": ("m", "of a tyre that rolls"),
}
