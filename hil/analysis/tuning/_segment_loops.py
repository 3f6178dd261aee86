"""The speed loop in each segment of a plan: its controller, how fast the car is, on which road."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from hil.analysis.tuning._driven import ControllerWalk
from hil.core.controller import Controller
from hil.core.model import Model
from hil.core.vehicle import VehicleAndRoad
from test_plans import Array, Plan, PlannedSegment, Quantity

_SLIDING = 1e-9  # of the tyre's stiffness and damping: its resonance then lies below any loop's analysis


@dataclass(frozen=True)
class DrivenSegment:
    """A segment of driving torque, as its plan leads up to it.

    Attributes:
        file: the controller that is loaded.
        speed_m_s: of the vehicle, as held last.
        mass_kg: of the vehicle, if the plan sets it.
        friction: of the road under the worse tyre, as a share of a dry one's.
    """

    id: str
    file: Path
    speed_m_s: float
    mass_kg: float | None
    friction: float


def driven_segments(plan: Plan) -> tuple[DrivenSegment, ...]:
    """All in which the wheel speed control acts; those of motor torque have no such loop."""
    walk = _RoadWalk()
    for step in plan.steps:
        step.execute(walk)
    return tuple(walk.segments)


class _RoadWalk(ControllerWalk):
    def __init__(self) -> None:
        super().__init__()
        self.segments: list[DrivenSegment] = []
        self._speed_m_s = 0.0
        self._friction = [1.0, 1.0]
        self._mass_kg: float | None = None

    def hold_speed(self, speed_m_s: float, duration_s: float) -> None:
        """From now on, nearly: torque changes it by little."""
        del duration_s
        self._speed_m_s = speed_m_s

    def set_vehicle(self, vehicle: VehicleAndRoad) -> None:
        """What is not set stays."""
        self._mass_kg = self._mass_kg if vehicle.mass_kg is None else vehicle.mass_kg
        for side, friction in enumerate((vehicle.friction_left, vehicle.friction_right)):
            self._friction[side] = self._friction[side] if friction is None else friction

    def ramp_down(self, duration_s: float) -> None:
        """To rest."""
        del duration_s
        self._speed_m_s = 0.0

    def play(self, quantity: Quantity, samples_nm: Array, segment: PlannedSegment | None) -> None:
        """A segment of driving torque closes the loop."""
        super().play(quantity, samples_nm, segment)
        if segment is not None and quantity == "driving_torque":
            friction = min(self._friction)
            found = DrivenSegment(segment.id, self.file, self._speed_m_s, self._mass_kg, friction)
            self.segments.append(found)


def with_mass(model: Model, mass_kg: float | None) -> Model:
    """A car of another mass: m·r² at the wheels, as the dynamometers' vehicle has it."""
    if mass_kg is None or "vehicle_inertia" not in model.parameters:
        return model
    return model.with_parameters(vehicle_inertia=mass_kg * model.wheel_radius_m**2)


def sliding(model: Model) -> Model | None:
    """The car while its tyres slide: their force then hardly changes with slip, and the vehicle is let go.

    None for a model without a tyre.
    """
    stiffness, damping = (model.parameters.get(name) for name in ("tyre_stiffness", "tyre_damping"))
    if stiffness is None or damping is None:
        return None
    return model.with_parameters(tyre_stiffness=_SLIDING * stiffness, tyre_damping=_SLIDING * damping)


def gain_factor(controller: Controller, speed_m_s: float) -> float:
    """What K_p and K_i are multiplied by at a speed; 1 without a schedule."""
    schedule = controller.schedule
    if schedule is None:
        return 1.0
    return float(np.interp(speed_m_s, schedule.speed_m_s, schedule.wsc_factor))
