"""The constants of a reference plant, as one tuple that the compiled loops read by name."""

from __future__ import annotations

import math
from collections import namedtuple
from collections.abc import Mapping

#: name: value that switches the law off (or has no influence). SI units; wheel side except the rotor's.
OFF: dict[str, float] = {
    "motor_inertia": 0.0,
    "gear_ratio": 1.0,
    "shaft_stiffness": 0.0,
    "shaft_damping": 0.0,
    "wheel_inertia": 0.0,
    "has_tyre": 0.0,
    "tyre_stiffness": 0.0,
    "tyre_damping": 0.0,
    "vehicle_inertia": 0.0,
    "viscous_drag": 0.0,
    # torque path
    "delay_s": 0.0,
    "lag_s": 0.0,
    "limit_nm": math.inf,
    "rate_nm_s": math.inf,
    "deadband_nm": 0.0,
    "torque_gain": 1.0,
    # contact and shaft
    "half_gap": 0.0,
    "contact_form": 1.0,  # series, dissipative, Kelvin-Voigt, Hunt-Crossley: see contact.py
    "contact_depth": 1e-3,
    "contact_damping": 0.0,  # N m s/rad of closed flanks, beside the shafts' own
    "cubic": 0.0,
    "hysteresis": 0.0,  # 1: Bouc-Wen, 2: Masing
    "hysteresis_stiffness": 0.0,
    "hysteresis_slip": 1.0,
    "hysteresis_sharpness": 2.0,
    # rotor
    "coulomb": 0.0,
    "stribeck": 0.0,
    "stribeck_speed": 4.0,
    "stribeck_power": 2.0,  # 2: Gaussian, 1: exponential
    "bristle_stiffness": 2000.0,
    "bristle_damping": 0.5,
    "bristle_exponent": 1.0,  # 1: LuGre, Dahl; others: Dahl's exponent
    "friction_offset": 0.0,
    "motor_order": 0.0,
    "motor_amplitude": 0.0,
    "motor_phase": 0.0,
    # housing
    "has_mount": 0.0,
    "housing_inertia": 1.0,
    "mount_stiffness": 0.0,
    "mount_damping": 0.0,
    # wheel and load
    "wheel_order": 0.0,
    "wheel_amplitude": 0.0,
    "wheel_phase": 0.0,
    "wheel_radius": 0.33,
    "slip_stiffness": 0.0,  # N m per slip; 0: the tyre is a spring
    "relaxation_length": 1.0,
    "patch_cells": 1.0,
    "dyno_lag_s": 0.0,
    "rolling": 0.0,
    "rolling_speed": 0.02,
    "aero": 0.0,
    # outside the registry
    "mount_speed_stiffening": 0.0,  # s/rad, relative growth of the bushes' stiffness with wheel speed
    "torque_fade": 0.0,  # relative loss of torque once the machine is warm
    "fade_time_s": 20.0,
    "shaft_asymmetry": 0.0,  # relative change of stiffness in negative twist
    "shaft_drift": 0.0,  # relative change of stiffness per second
    "squeeze_damping": 0.0,  # N m s²/rad², shaft torque by the square of the twist rate
    "absorber_inertia": 0.0,
    "absorber_stiffness": 0.0,
    "absorber_damping": 0.0,
    "tone_nm": 0.0,
    "tone_hz": 0.0,
}

#: A named tuple and not an array's record: compiled code keeps it in registers, no store can change it.
Constants = namedtuple("Constants", OFF)  # type: ignore[misc]


def record(values: Mapping[str, float]) -> Constants:
    """Constants with `values`, everything else switched off.

    Raises:
        KeyError: a name that no law reads.
    """
    unknown = set(values) - set(OFF)
    if unknown:
        raise KeyError(f"no law reads {sorted(unknown)}")
    return Constants(**{name: float(value) for name, value in (OFF | dict(values)).items()})
