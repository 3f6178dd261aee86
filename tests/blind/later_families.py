"""Effects, and forms of effects, that joined the set after its first cases were drawn.

They stand apart from `families` so that what chooses among those (pairs, outsiders) draws as it did before.
A subject is an effect's id, or `id:form` where the effect has a family already.
"""

from __future__ import annotations

import math

import numpy as np

from hil.core.channels import OUTPUTS
from tests.blind.families import Draw, Family, Hidden, Setting
from tests.blind.reference.contact import DISSIPATIVE, SERIES
from tests.blind.reference.tyre import CELLS
from tests.blind.sensors import Sensor

_WIDE_GAP = 0.003  # rad
_WHEEL_RADIUS = 0.33  # m, what a model file means that says nothing


def _tyre_slip(rng: np.random.Generator, setting: Setting) -> Family:
    """At rest as stiff as the tyre of the model; the shorter the relaxation length, the larger the effect."""
    cells = float(rng.integers(1, CELLS, endpoint=True))
    stiffness = setting.parameters["tyre_stiffness"]

    def of_size(size: float) -> Hidden:
        relaxation = 1.0 / size
        slip = stiffness * relaxation / _WHEEL_RADIUS
        laws = {"slip_stiffness": slip, "relaxation_length": relaxation, "patch_cells": cells}
        return Hidden("tyre_slip", laws, (), {"slip_stiffness_nm": slip, "relaxation_length_m": relaxation})

    return Family("tyre_slip", 1e-3, 10.0, of_size)


def _dyno_lag(rng: np.random.Generator, setting: Setting) -> Family:
    """At most half of what makes the load swing: a tyre of damping D holds a load that is D/K late."""
    del rng
    longest = 0.5 * setting.parameters["tyre_damping"] / setting.parameters["tyre_stiffness"]

    def of_size(size: float) -> Hidden:
        return Hidden("dyno_lag", {"dyno_lag_s": size}, (), {"time_constant_s": size})

    return Family("dyno_lag", 1e-5, longest, of_size)


def turn_of(torque_nm: float, stiffness_nm_rad: float, exponent: float) -> float:
    """Angle in rad over which Dahl's friction turns around: of an exponential that loses the same work.

    After a reversal the share 1 - F/T_c that is missing starts at 2 and falls with d(share)/d(angle)
    = -(stiffness/T_c) share**n; its integral is 2 turn for an exponential.
    """
    return torque_nm / stiffness_nm_rad * math.pow(2.0, 1.0 - exponent) / (2.0 - exponent)


def _turning_friction(rng: np.random.Generator, setting: Setting) -> Family:
    turn = math.exp(rng.uniform(math.log(0.03), math.log(0.5)))
    exponent = float(rng.choice([rng.uniform(0.6, 0.9), 1.0, rng.uniform(1.15, 1.4)]))

    def of_size(size: float) -> Hidden:
        laws = {
            "coulomb": size,
            "bristle_stiffness": size / turn * turn_of(1.0, 1.0, exponent),
            "bristle_exponent": exponent,
            "bristle_damping": 0.0,
        }
        return Hidden("coulomb_friction", laws, (), {"torque_nm": size, "turn_rad": turn})

    return Family("coulomb_friction", 0.01 * setting.scale, 6.0 * setting.scale, of_size)


def restitution_of(ratio: float) -> float:
    """Speed after over speed before of a mass that a spring and a damper of `ratio` push, but never pull."""
    root = math.sqrt(1.0 - ratio**2)
    angle = math.pi - math.atan2(2.0 * ratio * root, 1.0 - 2.0 * ratio**2)
    return math.exp(-ratio / root * angle) * (ratio / root * math.sin(angle) - math.cos(angle))


def _reduced_inertia(setting: Setting) -> float:
    """kg m² of rotor (wheel side) and wheel against each other."""
    p = setting.parameters
    rotor = p["motor_inertia"] * p["gear_ratio"] ** 2
    wheel = p["wheel_inertia"] if setting.kind == "three_inertia" else p["vehicle_inertia"]
    return rotor * wheel / (rotor + wheel)


def _flanks(setting: Setting, size: float, ratio: float, dissipative: bool, depth: float) -> dict[str, float]:
    """Laws of a gap whose flanks' damping, `ratio` of critical in wide gaps, vanishes with the gap."""
    critical = 2.0 * math.sqrt(setting.parameters["shaft_stiffness"] * _reduced_inertia(setting))
    return {
        "half_gap": size,
        "contact_form": DISSIPATIVE if dissipative and size > _WIDE_GAP else SERIES,
        "contact_depth": depth,
        "contact_damping": critical * ratio * size / (size + _WIDE_GAP),
    }


def _damped_backlash(rng: np.random.Generator, setting: Setting) -> Family:
    ratio, dissipative, depth = rng.uniform(0.08, 0.4), rng.uniform() < 0.4, rng.uniform(1e-4, 4e-4)

    def of_size(size: float) -> Hidden:
        laws = _flanks(setting, size, ratio, dissipative, depth)
        values = {"half_gap_rad": size, "contact_damping_nms_rad": laws["contact_damping"]}
        return Hidden("backlash", laws, (), {**values})

    return Family("backlash", 1e-4, 0.03, of_size)


def _bouncing_backlash(rng: np.random.Generator, setting: Setting) -> Family:
    """The same flanks, told by how fast rotor and wheel part again: without the shafts' own damping."""
    ratio, dissipative, depth = rng.uniform(0.08, 0.4), rng.uniform() < 0.4, rng.uniform(1e-4, 4e-4)

    def of_size(size: float) -> Hidden:
        laws = _flanks(setting, size, ratio, dissipative, depth)
        restitution = restitution_of(ratio * size / (size + _WIDE_GAP))
        return Hidden("backlash", laws, (), {"half_gap_rad": size, "restitution": restitution})

    return Family("backlash", 1e-4, 0.03, of_size)


def _torque_gain(rng: np.random.Generator, setting: Setting) -> Family:
    del setting
    sign = float(rng.choice([-1.0, 1.0]))

    def of_size(size: float) -> Hidden:
        return Hidden("torque_gain", {"torque_gain": 1.0 + sign * size}, (), {"gain": 1.0 + sign * size})

    return Family("torque_gain", 1e-3, 0.6, of_size)


def _sensor_lag(rng: np.random.Generator, setting: Setting) -> Family:
    del setting
    channel = str(rng.choice(OUTPUTS))

    def of_size(size: float) -> Hidden:
        sensor = Sensor(channel, lag_s=size)
        return Hidden("sensor_lag", {}, (sensor,), {"channel": channel, "time_constant_s": size})

    return Family("sensor_lag", 1e-4, 0.1, of_size)


LATER_FAMILIES: dict[str, Draw] = {
    "tyre_slip": _tyre_slip,
    "dyno_lag": _dyno_lag,
    "coulomb_friction:turn": _turning_friction,
    "backlash:damped": _damped_backlash,
    "backlash:restitution": _bouncing_backlash,
    "torque_gain": _torque_gain,
    "sensor_lag": _sensor_lag,
}

#: Share of the usual noise: a vehicle hardly moves while its tyres twist, so that these show little of
#: themselves; on a bench as noisy as the others' no size of theirs would be seen.
QUIET = {"tyre_slip": 0.1, "dyno_lag": 0.03}


def later_fits(subject: str, kind: str) -> bool:
    """A tyre slips, and a dyno follows, where the wheel is a body of its own."""
    if subject in ("tyre_slip", "dyno_lag"):
        return kind == "three_inertia"
    return kind != "rigid" or subject in ("coulomb_friction:turn", "torque_gain", "sensor_lag")
