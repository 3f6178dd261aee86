"""What a plan will do to the axle: its peaks beside the bench's limits, its criteria judged beforehand."""

from __future__ import annotations

from dataclasses import dataclass

from hil.core.model import load_model
from hil.core.result import CriterionResult
from hil.engine.bench_file import DEFAULT_BENCH, load_bench
from hil.engine.bench_tables import BenchFile
from hil.engine.prediction import predict
from hil.engine.ranges import limits_of_channels
from test_plans import Plan, judge


@dataclass(frozen=True)
class Forecast:
    """`peaks` has the largest magnitude of each limited channel with its limit, in the channel's unit.

    `bus_loads` has the share of each bus that the frames of every millisecond take, at most.
    """

    peaks: dict[str, tuple[float, float]]
    criteria: tuple[CriterionResult, ...]
    bus_loads: dict[str, float]

    @property
    def fits(self) -> bool:
        """Whether every peak is within its limit, and every bus carries its frames."""
        within = all(value <= limit for value, limit in self.peaks.values())
        return within and not self.overloaded

    @property
    def overloaded(self) -> tuple[str, ...]:
        """Buses that have more to carry than they can."""
        return tuple(name for name, load in self.bus_loads.items() if load > 1.0)


def forecast(plan: Plan, bench: BenchFile) -> Forecast:
    """Carry the plan out on a predicted bench and judge it.

    No limit on measured values trips meanwhile, and sensors have no noise. A bench without a [simulation]
    is predicted with the shipped simulated bench's model.

    Raises:
        BadInputError: the plan asks for more than the bench allows.
        HilError: the run would fail.
    """
    simulation = bench.simulation or load_bench(DEFAULT_BENCH).simulation
    assert simulation is not None, "the default bench is simulated"
    found = predict(plan, bench, load_model(simulation.model))
    limits = limits_of_channels(bench.limits)
    peaks = {channel: (found.peaks[channel], limit) for channel, limit in limits.items()}
    return Forecast(peaks, judge(plan, found.recording, found.segments, measured=False), found.bus_loads)
