"""`set_vehicle`: the vehicle and the road that the dynos simulate from now on, set at their panel."""

from __future__ import annotations

from typing import ClassVar, Self

from pydantic import Field, model_validator

from hil.core.vehicle import VehicleAndRoad
from test_plans.conductor import Conductor
from test_plans.pace import Outlook, Pace
from test_plans.steps._step import Step

_TAKES_S = 0.5  # some exchanges of a few hundredths of a second each


class SetVehicle(Step):
    """Write mass, road load, slip and friction at the RC-S's panel and read them back; the rest stays."""

    kind: ClassVar[str] = "set_vehicle"
    mass_kg: float | None = Field(None, gt=0, le=10_000, description="of the vehicle")
    f0_n: float | None = Field(None, ge=0, le=10_000, description="road load f0 + f1·v + f2·v²: N")
    f1_ns_m: float | None = Field(None, ge=0, le=1_000, description="N s/m")
    f2_ns2_m2: float | None = Field(None, ge=0, le=100, description="N s²/m²")
    slip_percent: float | None = Field(None, ge=0, le=50, description="%, from 0 to 50")
    friction: float | None = Field(
        None, ge=0.001, le=1, description="of the road, as a share of a dry one's: 1 is dry, 0.05 ice"
    )
    friction_left: float | None = Field(None, ge=0.001, le=1, description="likewise under the left tyre")
    friction_right: float | None = Field(None, ge=0.001, le=1, description="likewise under the right tyre")

    @model_validator(mode="after")
    def _says_something(self) -> Self:
        if self._vehicle() == VehicleAndRoad():
            raise ValueError("sets nothing; give mass_kg, f0_n, f1_ns_m, f2_ns2_m2, slip_percent or friction")
        if self.friction is not None and (self.friction_left, self.friction_right) != (None, None):
            raise ValueError("friction is that of both sides; give it, or friction_left and friction_right")
        return self

    def _vehicle(self) -> VehicleAndRoad:
        slip = None if self.slip_percent is None else self.slip_percent / 100.0
        left, right = (
            self.friction if side is None else side for side in (self.friction_left, self.friction_right)
        )
        return VehicleAndRoad(self.mass_kg, self.f0_n, self.f1_ns_m, self.f2_ns2_m2, slip, left, right)

    def execute(self, conductor: Conductor) -> None:
        """Write it."""
        conductor.set_vehicle(self._vehicle())

    def outlook(self, speed_m_s: float, pace: Pace) -> Outlook:  # noqa: ARG002 - the line's own time
        """Some exchanges on a serial line."""
        return Outlook(_TAKES_S, speed_m_s)
