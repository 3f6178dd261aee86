"""Time in play and clunk of a reversal, with the shipped lead and with a crossing of the play.

From -150 to 300 N m at 30 km/h, through ±0.02 rad of play, on the fitted model and on 200 cars that are drawn
around it as `hil tune` draws them (load, tyre, shaft, dead time, the wheel order's place, noise of the
sensors): `python -m benchmarks.play_crossing`. Medians of all 201, and the value that nine in ten keep. A
second table draws the gap as well, from none to ±0.02 rad; the controller does not know which it is.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

import benches
import test_plans
from hil.analysis.tuning import Draw, Tolerance, draws_of
from hil.core.controller import Controller, load_controller
from hil.core.controller.shaping import RequestLimits
from hil.core.model import EffectUse, load_model
from hil.engine import DEFAULT_BENCH, load_bench
from hil.engine.prediction.batch_prediction import BatchPrediction
from test_plans import judge, plan_from_text

LIBRARY = Path(test_plans.__file__).parent / "library" / "controllers"
LEAD, CROSSING = LIBRARY / "phase_stabilization.toml", LIBRARY / "play_crossing.toml"
HALF_GAP_RAD, CARS, SEED = 0.02, 201, 1
#: As `hil tune` has it.
TOLERANCE = Tolerance(
    relative={"vehicle_inertia": 0.1, "tyre_stiffness": 0.2, "tyre_damping": 0.2, "shaft_stiffness": 0.05},
    dead_time_s=0.001,
    order_phase=True,
    sensor_noise=1.0,
)
#: By metric: unit, and by how much it is printed.
METRICS = {
    "response_time": ("ms", 1e3),
    "jerk": ("m/s³", 1.0),
    "time_in_play": ("ms", 1e3),
    "clunk": ("N m/s", 1.0),
    "overshoot": ("N m", 1.0),
}
PLAN = """
name: reversal
title: Regeneration to drive
steps:
  - set_controller: {file: phase_stabilization.toml}
  - hold_speed: {speed_km_h: 30, duration_s: 2}
  - step: {segment: reversal, quantity: driving_torque, from_nm: -150, to_nm: 300, before_s: 1.5, after_s: 3}
finally:
  - ramp_down: {duration_s: 2}
criteria:
  - {segment: reversal, metric: response_time, channel: shaft_torque_nm, upper: 1, unit: s}
  - {segment: reversal, metric: jerk, upper: 100, unit: m/s³}
  - {segment: reversal, metric: time_in_play, upper: 1, unit: s}
  - {segment: reversal, metric: clunk, upper: 100000, unit: N m/s}
  - {segment: reversal, metric: overshoot, channel: shaft_torque_nm, until: transient, upper: 1000, unit: N m}
"""


@dataclass(frozen=True)
class Figures:
    """Of one controller: each metric of `METRICS` in SI units, shape (cars, metrics)."""

    values: npt.NDArray[np.float64]

    @property
    def median(self) -> npt.NDArray[np.float64]:
        """Of all cars, by metric."""
        return np.asarray(np.nanmedian(self.values, axis=0))

    @property
    def nine_in_ten(self) -> npt.NDArray[np.float64]:
        """What nine cars in ten do not exceed, by metric."""
        return np.asarray(np.nanpercentile(self.values, 90, axis=0))


def controllers() -> dict[str, Controller | None]:
    """What is compared, by name; None is the shipped lead."""
    crossing = load_controller(CROSSING)
    assert crossing.play is not None
    blind = crossing.play.model_copy(update={"correction": 0.0})
    slower = crossing.play.model_copy(
        update={
            "crossing_speed_rad_s": 1.5,
            "follow_gradient_nm_s": 6000.0,
            "follow_time_constant_s": 0.015,
        }
    )
    limits = RequestLimits(zero_band_nm=60.0, zero_gradient_nm_s=3000.0)
    return {
        "shipped lead": None,
        "lead, 3,000 N m/s between ±60 N m": load_controller(LEAD).model_copy(update={"request": limits}),
        "crossing of the play": crossing,
        "slower: 1.5 rad/s, 6,000 N m/s, 15 ms": crossing.model_copy(update={"play": slower}),
        "without correction": crossing.model_copy(update={"play": blind}),
    }


def cars(count: int = CARS, drawn_gap_rad: float = 0.0) -> tuple[Draw, ...]:
    """The fitted model with play, and others around it; with `drawn_gap_rad` its gap is drawn, too."""
    shipped = load_model(Path(benches.__file__).parent / "three_inertia.toml")
    model = shipped.with_effects(*shipped.effects, EffectUse("backlash", {"half_gap_rad": HALF_GAP_RAD}))
    tolerance = TOLERANCE.model_copy(update={"backlash_rad": drawn_gap_rad})
    return draws_of(model, tolerance, count - 1, SEED)


def figures(controller: Controller | None, drawn: Iterable[Draw]) -> Figures:
    """The reversal with a controller, on every car."""
    plan = plan_from_text(PLAN, "reversal.yaml", LIBRARY)
    channels = frozenset({"shaft_torque_nm", "vehicle_speed_m_s", "wheel_speed_rad_s"})
    runs = BatchPrediction(plan, load_bench(DEFAULT_BENCH), LEAD, channels)
    rows = []
    for car in drawn:
        found = runs(car.model, controller, car.noise, car.seed)
        results = judge(plan, found.recording, found.segments, measured=False, device=False)
        rows.append([np.nan if one.value is None else one.value for one in results])
    return Figures(np.array(rows))


def _three(value: float) -> str:
    """Three digits, without an exponent."""
    return f"{float(f'{value:.3g}'):,g}"


def main() -> None:
    """Print both tables."""
    for gap_rad, words in ((0.0, "of ±0.02 rad"), (HALF_GAP_RAD, "drawn from none to ±0.02 rad")):
        drawn = cars(drawn_gap_rad=gap_rad)
        print(f"\n{len(drawn)} cars, a gap {words}: median (nine in ten)\n")
        heads = " | ".join(f"{name}, {unit}" for name, (unit, _) in METRICS.items())
        print(f"| control | {heads} |\n|---|" + "---|" * len(METRICS))
        lead: Figures | None = None
        for name, controller in controllers().items():
            one = figures(controller, drawn)
            lead = lead or one
            cells = [
                f"{_three(scale * median)} ({_three(scale * most)}) {median / base - 1:+.0%}"
                for median, most, base, (_, scale) in zip(
                    one.median, one.nine_in_ten, lead.median, METRICS.values(), strict=True
                )
            ]
            print(f"| {name} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
