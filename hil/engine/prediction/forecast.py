"""What a plan will do to the axle: its peaks beside the bench's limits, its criteria judged beforehand."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from pathlib import Path

from hil.core.errors import BadInputError
from hil.core.model import load_model
from hil.core.result import CriterionResult
from hil.engine.bench.bench_file import DEFAULT_BENCH, load_bench
from hil.engine.bench.bench_tables import BenchFile
from hil.engine.bench.ranges import limits_of_channels
from hil.engine.prediction._predicted_bench import PredictedBench
from hil.engine.prediction.prediction import PredictedRun
from hil.engine.run.preflight import rehearsed
from test_plans import Judgement, Plan, estimate_duration_s

#: An analysis step may ask for all that was recorded before it: 225 bytes a sample.
LONGEST_WITH_ANALYSIS_S = 2 * 3600.0


@dataclass(frozen=True)
class Forecast:
    """`peaks` has the largest magnitude of each limited channel with its limit, in the channel's unit.

    `bus_loads` has the share of each bus that the frames of every millisecond take, at most; `duration_s` is
    the bench time of steps and end steps, operator prompts not counted.
    """

    peaks: dict[str, tuple[float, float]]
    criteria: tuple[CriterionResult, ...]
    bus_loads: dict[str, float]
    duration_s: float

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
    is predicted with the shipped simulated bench's model. Each segment is judged as it ends and then
    forgotten, so that memory hangs on the longest segment and not on the plan.

    Raises:
        BadInputError: the plan asks for more than the bench allows, or analyses itself and is too long.
        HilError: the run would fail.
    """
    simulation = bench.simulation or load_bench(DEFAULT_BENCH).simulation
    assert simulation is not None, "the default bench is simulated"
    judgement = Judgement(plan, measured=False)
    with tempfile.TemporaryDirectory() as folder:
        predicted = PredictedBench(bench, load_model(simulation.model))
        run = PredictedRun(
            predicted, Path(folder), each_segment=judgement.take, keeps_rows=_analyses(plan, bench)
        )
        begin_s = predicted.loop.clock.now_s()
        run.execute((*plan.steps, *plan.finally_))
        duration_s = predicted.loop.clock.now_s() - begin_s
        found = run.ended()
    limits = limits_of_channels(bench.limits)
    peaks = {channel: (found.peaks[channel], limit) for channel, limit in limits.items()}
    return Forecast(peaks, judgement.results(), found.bus_loads, duration_s)


def _analyses(plan: Plan, bench: BenchFile) -> bool:
    """Whether a step analyses what was recorded before it.

    Raises:
        BadInputError: it does, and the plan is so long that this cannot be predicted in little memory.
    """
    analyses = bool(rehearsed(plan, bench).made)
    duration_s = estimate_duration_s(plan)
    if analyses and duration_s > LONGEST_WITH_ANALYSIS_S:
        raise BadInputError(
            f"takes {duration_s / 3600:.1f} h and analyses its own recording: at most "
            f"{LONGEST_WITH_ANALYSIS_S / 3600:g} h of such a plan are predicted",
            where=str(plan.source),
            fix="make two plans of it: one that identifies, and one for the rest",
        )
    return analyses
