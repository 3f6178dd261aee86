"""The RMCU's parameter store: written over the bus one by one, used after 'apply' has checked them all."""

from __future__ import annotations

import math
from collections.abc import Mapping

from hil.core.controller.bounds import LARGEST_TORQUE_NM, SAMPLE_TIMES_S
from hil.plant.controller.driving_force_control import DrivingForceControl
from hil.plant.controller.driving_force_observer import DrivingForceObserver
from hil.plant.controller.memory import SAMPLE_TIME, TORQUE_LIMIT, Memory
from hil.plant.controller.wheel_speed_control import Notch, PhaseLead, SpeedFilter, WheelSpeedControl

OK, UNKNOWN_INDEX, OUT_OF_RANGE, NOT_OFF, INCOMPLETE = range(5)
COEFFICIENTS = 8


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
    p = parameters
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
    memory.gains[TORQUE_LIMIT] = p["torque_limit"]
    return OK


def _polynomial(parameters: Mapping[str, float], part: str) -> list[float]:
    """Coefficients of a polynomial in descending powers of s; x_0 belongs to s⁰."""
    return [parameters[f"{part}_{power}"] for power in reversed(range(COEFFICIENTS))]
