"""The vehicle and the road that a dynamometer simulates, as a person sets them."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class VehicleAndRoad:
    """Mass, road load F = f0 + f1·v + f2·v², slip and friction; None leaves what is set.

    Attributes:
        f0_n, f1_ns_m, f2_ns2_m2: N, N s/m, N s²/m², with v in m/s.
        slip: share of the wheels' speed by which the vehicle is slower.
        friction_left, friction_right: under each tyre, a share of what the tyres hold on a dry road.
    """

    mass_kg: float | None = None
    f0_n: float | None = None
    f1_ns_m: float | None = None
    f2_ns2_m2: float | None = None
    slip: float | None = None
    friction_left: float | None = None
    friction_right: float | None = None

    def at_wheels(self, wheel_radius_m: float) -> dict[str, float]:
        """As a vehicle model at the wheels has it: kg m², N m, N m s²/rad²; f1 has no counterpart there."""
        values = {
            "inertia_kg_m2": (self.mass_kg, 2),
            "rolling_nm": (self.f0_n, 1),
            "aero_nms2_rad2": (self.f2_ns2_m2, 3),
            "slip": (self.slip, 0),
            "friction_left": (self.friction_left, 0),
            "friction_right": (self.friction_right, 0),
        }
        return {
            name: value * wheel_radius_m**power
            for name, (value, power) in values.items()
            if value is not None
        }
