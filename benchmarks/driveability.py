"""Where the limits of `driveability` and `abs_release` come from: `python -m benchmarks.driveability`.

Each plan is predicted on the fitted model, with the shipped phase lead and without noise. A limit lies a
stated share of the value beyond it, rounded to three digits. Time in play is taken from the largest value
over the speeds of a manoeuvre: it hangs on how the torque passes through zero, and jumps.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from hil.core.model import load_model
from hil.engine import DEFAULT_BENCH, load_bench
from hil.engine.prediction.prediction import predict
from test_plans import Criterion, judge, load_plan

#: How far a limit lies beyond the fitted model's value, by metric.
SHARES = {
    "overshoot": 0.10,
    "trough": 0.10,
    "magnitude": 0.10,
    "response_time": 0.10,
    "jerk": 0.10,
    "vibration_dose": 0.10,
    "time_in_play": 0.25,
    "clunk": 0.25,
    "contact_energy": 0.25,
}
_MODEL = Path(__file__).parents[1] / "benches/three_inertia.toml"
LEAST_NM = 8.0  # beyond the value, of torques: noise and the order's place in its turn move them so far
ROUNDING = 0.01
_OVER_SPEEDS = ("time_in_play",)


@dataclass(frozen=True)
class Derived:
    """A criterion of a plan, the fitted model's value that counts, and the limit that comes of it."""

    criterion: Criterion
    value: float
    limit: float


#: Shipped plans whose limits are derived so.
PLANS = ("driveability", "abs_release")


def derived(name_of_plan: str) -> list[Derived]:
    """Every criterion of a shipped plan, in its order."""
    plan = load_plan(name_of_plan)
    bench = load_bench(DEFAULT_BENCH)
    found = predict(plan, bench, load_model(_MODEL))
    results = judge(plan, found.recording, found.segments, measured=False, device=False)
    values = {one.id: one.value for one in results}
    derived = []
    for criterion in plan.criteria:
        name = criterion.metric.name
        value = values[criterion.id]
        assert value is not None, criterion.id
        if name in _OVER_SPEEDS:
            value = max(
                values[one.id] or 0.0
                for one in plan.criteria
                if one.metric.name == name and manoeuvre(one.segment) == manoeuvre(criterion.segment)
            )
        room = SHARES[name] * abs(value)
        if criterion.metric.unit == "N m":
            room = max(room, LEAST_NM)
        derived.append(
            Derived(criterion, value, value - room if criterion.lower is not None else value + room)
        )
    return derived


def misplaced(one: Derived) -> bool:
    """Whether the plan's limit is elsewhere than derived, by more than rounding to three digits makes."""
    own = one.criterion
    limit = own.upper if own.lower is None else own.lower
    return limit is None or abs(limit - one.limit) > ROUNDING * abs(one.limit)


def manoeuvre(segment: str) -> str:
    """A segment's name without its speed or rate."""
    return segment.rstrip("0123456789").rstrip("_")


def main() -> None:
    """Print where each limit comes from."""
    print(f"{'criterion':<36}{'fitted':>10}{'derived':>10}{'plan':>10}  unit")
    for one in (one for name in PLANS for one in derived(name)):
        criterion = one.criterion
        limit = criterion.upper if criterion.lower is None else criterion.lower
        print(
            f"{criterion.id:<36}{one.value:>10.4g}{one.limit:>10.4g}{limit:>10.4g}  {criterion.metric.unit}"
        )


if __name__ == "__main__":
    main()
