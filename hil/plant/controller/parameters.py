"""The RMCU's parameter store: written over the bus one by one, used after 'apply' has checked them all."""

from __future__ import annotations

import math
from collections.abc import Mapping

from hil.core.controller.bounds import LARGEST_TORQUE_NM, MOST_SCHEDULE_POINTS, SAMPLE_TIMES_S
from hil.plant.controller.driving_force import DrivingForceControl, DrivingForceObserver
from hil.plant.controller.gain_schedule import GainSchedule
from hil.plant.controller.memory import GEAR_RATIO, SAMPLE_TIME, TORQUE_LIMIT, Memory
from hil.plant.controller.play_crossing import PlayCrossing
from hil.plant.controller.request_governor import RequestGovernor
from hil.plant.controller.wheel_speed_control import Notch, PhaseLead, SpeedFilter, WheelSpeedControl

OK, UNKNOWN_INDEX, OUT_OF_RANGE, NOT_OFF, INCOMPLETE = range(5)
COEFFICIENTS = 8

#: Parameters that are 0, and what belongs to them off, where they were not written before 'apply'.
OPTIONAL = (
    "request_rise",
    "request_fall",
    "zero_band",
    "zero_gradient",
    "slip_allowed",
    "slip_recovery",
    "play_half_gap",
    "play_crossing_speed",
    "play_crossing_torque",
    "play_follow_gradient",
    "play_follow_time",
    "play_release_gradient",
    "play_landing_margin",
    "play_correction",
    "play_motor_inertia",
    "play_shaft_stiffness",
    "play_shaft_damping",
    "play_tyre_stiffness",
    "play_tyre_damping",
    "play_vehicle_inertia",
    "play_dead_time",
    "play_gain_factor",
    "schedule_points",
    *(
        f"schedule_{part}_{place}"
        for part in ("speed", "wsc", "dfc")
        for place in range(MOST_SCHEDULE_POINTS)
    ),
)


def in_range(name: str, value: float) -> bool:
    """Whether the RMCU stores this value at all."""
    if not math.isfinite(value):
        return False
    if name == "torque_limit":
        return 0.0 < value <= LARGEST_TORQUE_NM
    if name == "sample_time":
        return SAMPLE_TIMES_S[0] <= value <= SAMPLE_TIMES_S[1]
    return True


def build(parameters: Mapping[str, float], memory: Memory) -> int:
    """Build every block from `parameters` into `memory`; INCOMPLETE or OUT_OF_RANGE leaves it as it was."""
    p = {**dict.fromkeys(OPTIONAL, 0.0), **parameters}
    try:
        dt = p["sample_time"]
        den, motor, wheel, shaft = (_polynomial(p, part) for part in ("den", "motor", "wheel", "shaft"))
        stabilizer: PhaseLead | Notch | None = None
        if p["lead_t"] > 0.0:
            stabilizer = PhaseLead(p["lead_gain"], p["lead_alpha"], p["lead_t"], dt)
        elif p["notch_frequency"] > 0.0:
            stabilizer = Notch(p["notch_frequency"], p["notch_width"], p["notch_depth"], dt)
        blocks = (
            DrivingForceControl(
                p["k_i_dfc"], p["tau_2"], p["wheel_radius"], p["sigma"], p["slip_limit"], shaft, den, dt
            ),
            WheelSpeedControl(p["k_p"], p["k_i"], SpeedFilter(p["tau_1"], motor, wheel, dt), stabilizer),
            DrivingForceObserver(p["tau_dfo"], p["gear_ratio"], p["wheel_inertia"], dt),
            RequestGovernor(p),
            GainSchedule(p),
            PlayCrossing(p),
        )
    except KeyError:
        return INCOMPLETE
    except (ValueError, ZeroDivisionError):
        return OUT_OF_RANGE
    if min(p["wheel_radius"], p["sigma"], p["torque_limit"]) <= 0.0:
        return OUT_OF_RANGE
    for block in blocks:
        block.load(memory)
    memory.gains[SAMPLE_TIME] = dt
    memory.gains[GEAR_RATIO] = p["gear_ratio"]
    memory.gains[TORQUE_LIMIT] = p["torque_limit"]
    return OK


def _polynomial(parameters: Mapping[str, float], part: str) -> list[float]:
    """Coefficients of a polynomial in descending powers of s; x_0 belongs to s⁰."""
    return [parameters[f"{part}_{power}"] for power in reversed(range(COEFFICIENTS))]
