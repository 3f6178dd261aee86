"""A road that is slippery on one side: shafts, wheels and yaw torque.

200 N m are asked for at the wheels at 10 km/h for 6 s, with the left tyre on ice (5 % of the friction under
the right one), an open differential and one whose friction is 300 N m. The yaw torque on the vehicle is half
of the track, 1.5 m, times the difference of both tyres' forces.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

import benches
from benchmarks.low_friction import on_the_road
from hil.core.effects import EFFECTS
from hil.core.model import EffectUse, Model, load_model

END_S, TRACK_M = 7.0, 1.5
ROAD = {"peak_nm": 3000.0, "sliding_nm": 2400.0}
SHAFT_LIMIT_NM = 600.0  # of each side, on the shipped benches


@dataclass(frozen=True)
class Ride:
    """Largest torque of a half shaft (N m), by how much wheels part (rad/s), largest yaw torque (N m)."""

    shaft_nm: float
    apart_rad_s: float
    yaw_nm: float


def split_axle(differential_friction_nm: float) -> Model:
    """The shipped three-inertia axle without its wheel order, on that road."""
    shipped = load_model(Path(benches.__file__).parent / "three_inertia.toml")
    uses = {
        "tyre_friction": ROAD,
        "separate_wheels": {"differential_friction_nm": differential_friction_nm, "friction_left": 0.05},
    }
    effects = tuple(EffectUse(id_, EFFECTS[id_].check(values, "road")) for id_, values in uses.items())
    return Model(shipped.kind, shipped.parameters, effects)


def ride(controller: str, differential_friction_nm: float) -> Ride:
    """A step on that road, by a shipped controller's name; '' without one."""
    model = split_axle(differential_friction_nm)
    axle, _, asked_nm = on_the_road(model, controller, END_S)
    sides = axle.play_sides(asked_nm)
    shafts, wheels, roads = sides["shaft_torque_nm"], sides["wheel_speed_rad_s"], sides["dyno_torque_nm"]
    yaw = 0.5 * TRACK_M * np.abs(roads[:, 0] - roads[:, 1]) / model.wheel_radius_m
    return Ride(
        float(np.abs(shafts).max()), float(np.abs(wheels[:, 0] - wheels[:, 1]).max()), float(yaw.max())
    )


def main() -> None:
    """Print a row each."""
    print(
        f"| control | differential | largest half shaft, N m (limit {SHAFT_LIMIT_NM:g}) "
        "| wheels apart, rad/s | yaw torque, N m |\n|---|---|---|---|---|"
    )
    for name, words in (("", "none"), ("phase_stabilization", "lead"), ("gain_stabilization", "notch")):
        for friction_nm in (0.0, 300.0):
            one = ride(name, friction_nm)
            kind = f"{friction_nm:g} N m" if friction_nm else "open"
            print(f"| {words} | {kind} | {one.shaft_nm:.0f} | {one.apart_rad_s:.1f} | {one.yaw_nm:.0f} |")


if __name__ == "__main__":
    main()
