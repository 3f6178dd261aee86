"""What an estimate of time assumes of bench and vehicle; nothing else depends on these numbers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from test_plans.conductor import Quantity


class Outlook(NamedTuple):
    """How long a step will take, and the vehicle speed that it leaves behind."""

    duration_s: float
    speed_m_s: float


@dataclass(frozen=True)
class Pace:
    """How fast a bench changes speed, by its dynos and by torque (defaults: the paper's vehicle)."""

    speed_ramp_m_s2: float = 4.0
    gear_ratio: float = 8.148
    wheel_radius_m: float = 0.33
    load_inertia_kg_m2: float = 307.4

    def ramp_s(self, from_m_s: float, to_m_s: float) -> float:
        """Time in which the dynos go from one speed to another."""
        return abs(to_m_s - from_m_s) / self.speed_ramp_m_s2

    def acceleration_m_s2(self, quantity: Quantity, torque_nm: float) -> float:
        """Acceleration of the simulated vehicle without running resistance."""
        ratio = self.gear_ratio if quantity == "motor_torque" else 1.0
        return torque_nm * ratio / self.load_inertia_kg_m2 * self.wheel_radius_m
