"""Shaft torque on a road with slippery patches, with and without control.

200 N m are asked for at the wheels at 10 km/h for 10 s. The patches are 2 m long, 2 m apart, and bear 120 N m
(96 once the tyre slides), the road between them 3,000 N m. Without control the motor gives N times less,
whatever the wheels do. Judged is the range of the shaft torque from half a second after the step on.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

import benches
import test_plans
from hil.core.controller import load_controller
from hil.core.controller.shaping import SlipWithdrawal
from hil.core.effects import EFFECTS
from hil.core.model import EffectUse, Model, load_model
from hil.fmu import Axle

ASKED_NM, SPEED_M_S, STEP_S, END_S = 200.0, 10 / 3.6, 1.0, 11.0
Array = npt.NDArray[np.float64]
ROAD = {"peak_nm": 3000.0, "sliding_nm": 2400.0, "patch_friction": 0.04, "patch_length_m": 2.0}
CONTROLLERS = Path(test_plans.__file__).parent / "library" / "controllers"


@dataclass(frozen=True)
class Ride:
    """How T_s swings (N m) and how far wheels run ahead of the vehicle (rad/s)."""

    lowest_nm: float
    highest_nm: float
    slip_rad_s: float

    @property
    def range_nm(self) -> float:
        """From the lowest to the highest."""
        return self.highest_nm - self.lowest_nm


def slippery_axle() -> Model:
    """The shipped three-inertia axle without its wheel order, on that road."""
    shipped = load_model(Path(benches.__file__).parent / "three_inertia.toml")
    friction = EffectUse("tyre_friction", EFFECTS["tyre_friction"].check(ROAD, "road"))
    return Model(shipped.kind, shipped.parameters, (friction,))


def on_the_road(
    model: Model, controller: str, end_s: float, slip: SlipWithdrawal | None = None
) -> tuple[Axle, Array, Array]:
    """An axle at speed, with a shipped controller by name ('': none); times in s, torque that is asked.

    With `slip` the controller withdraws what the road does not bear.
    """
    file = load_controller(CONTROLLERS / f"{controller}.toml") if controller else None
    if file is not None and slip is not None:
        file = file.model_copy(update={"slip": slip})
    time_s = np.arange(0.0, end_s, 1e-3)
    asked_nm = ASKED_NM if controller else ASKED_NM / model.parameters["gear_ratio"]
    axle = Axle(model, file, initial_speed_m_s=SPEED_M_S)
    return axle, time_s, np.where(time_s >= STEP_S, asked_nm, 0.0)


def ride(controller: str, slip: SlipWithdrawal | None = None) -> Ride:
    """A step on that road, by a shipped controller's name; '' without one."""
    model = slippery_axle()
    axle, time_s, asked_nm = on_the_road(model, controller, END_S, slip)
    out = axle.play(asked_nm)
    shaft = out["shaft_torque_nm"][time_s >= STEP_S + 0.5]
    ahead = out["wheel_speed_rad_s"] - out["vehicle_speed_m_s"] / model.wheel_radius_m
    return Ride(float(shaft.min()), float(shaft.max()), float(ahead.max()))


def main() -> None:
    """Print a row each."""
    free = ride("")
    print(
        "| control | T_s from, N m | to, N m | range, N m | against none | slip, rad/s |\n"
        "|---|---|---|---|---|---|"
    )
    for name, words, slip in (
        ("", "none", None),
        ("phase_stabilization", "lead", None),
        ("gain_stabilization", "notch", None),
        ("phase_stabilization", "lead, slip up to 10 %", SlipWithdrawal(allowed=0.1)),
        ("phase_stabilization", "lead, slip up to 5 %", SlipWithdrawal(allowed=0.05)),
    ):
        one = ride(name, slip)
        print(
            f"| {words} | {one.lowest_nm:.0f} | {one.highest_nm:.0f} | {one.range_nm:.0f} "
            f"| {one.range_nm / free.range_nm - 1:+.0%} | {one.slip_rad_s:.1f} |"
        )


if __name__ == "__main__":
    main()
