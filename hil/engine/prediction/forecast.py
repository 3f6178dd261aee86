"""What a plan will do to the axle: peaks beside limits, criteria; and the envelope of a consent.

An envelope is what somebody consents to before a series of runs: largest values of channels, how many
runs, how long. The bench's own limits lie below it and cannot be raised; within a run it is watched like
them.
"""

from __future__ import annotations

import tempfile
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import tomli_w

from hil.core.channels import CHANNELS
from hil.core.errors import BadInputError
from hil.core.errors.wording import did_you_mean
from hil.core.model import load_model
from hil.core.result import CriterionResult
from hil.engine.bench.bench_file import DEFAULT_BENCH, bench_from_dict, load_bench
from hil.engine.bench.bench_tables import BenchFile
from hil.engine.bench.ranges import limits_of_channels
from hil.engine.prediction._predicted_bench import PredictedBench
from hil.engine.prediction.prediction import PredictedRun
from hil.engine.run.preflight import rehearsed
from test_plans import Judgement, Plan, estimate_duration_s

#: Room over the predicted peaks of the plan as it is: what a refined controller may ask for more.
ROOM = 1.3
#: Room over the time that the plan is expected to take.
_TIME_ROOM = 1.25
BENCH_TIME = "bench_time_s"
_NAME = "envelope_"


@dataclass(frozen=True)
class Envelope:
    """Largest magnitudes by channel, in its unit; runs and seconds of bench time, both in all."""

    largest: Mapping[str, float]
    runs: int
    bench_time_s: float

    def beyond(self, peaks: Mapping[str, float]) -> str:
        """Which of the largest magnitudes of a run are beyond it, in words; '' if none is."""
        over = [
            f"{name} {peaks[name]:.4g} of {limit:.4g} {CHANNELS[name].unit}"
            for name, limit in self.largest.items()
            if peaks.get(name, 0.0) > limit
        ]
        return ", ".join(over)

    def in_words(self) -> str:
        """The envelope in words."""
        values = (f"{name} {limit:.4g} {CHANNELS[name].unit}" for name, limit in self.largest.items())
        minutes = f"{self.bench_time_s / 60:.3g} min of bench time"
        return f"at most {self.runs} runs and {minutes} in all; at most {', '.join(values)}"

    def watched_on(self, bench: BenchFile) -> BenchFile:
        """The bench with limits of its own for it: a run that leaves it trips."""
        data = tomllib.loads(bench.text)
        watch = data["limits"].setdefault("watch", {})
        for name, limit in self.largest.items():
            watch[f"{_NAME}{name}"] = {
                "channel": name,
                "unit": CHANNELS[name].unit,
                "below": -limit,
                "above": limit,
            }
        return bench_from_dict(data, tomli_w.dumps(data), bench.source)


def envelope_of(
    bench: BenchFile, peaks: Mapping[str, float], runs: int, run_s: float, asked: Mapping[str, float]
) -> Envelope:
    """An envelope around a predicted run, never beyond the bench's limits.

    Args:
        peaks: largest magnitudes of the plan as it is, predicted, by channel.
        runs: at most; run_s: expected bench time of one.
        asked: what somebody states in place of it, by channel, or `bench_time_s`.

    Raises:
        BadInputError: a name that is not limited, a value that is none or beyond the bench's limit, or one
            that the plan itself leaves.
    """
    limits = {name: limit for name, limit in limits_of_channels(bench.limits).items() if name in peaks}
    for name, value in asked.items():
        if name not in (*limits, BENCH_TIME):
            raise BadInputError(
                f"the bench '{bench.name}' limits no '{name}'",
                where="--envelope",
                fix=did_you_mean(name, [*limits, BENCH_TIME]),
            )
        if not 0 < value <= limits.get(name, value):
            most = f" up to the bench's {limits[name]:g}" if name in limits else ""
            raise BadInputError(f"{name} = {value:g}", where="--envelope", fix=f"give a number above 0{most}")
    largest = {
        name: float(f"{min(limit, ROOM * peaks[name]):.3g}")
        for name, limit in limits.items()
        if peaks[name] > 0
    } | {name: value for name, value in asked.items() if name != BENCH_TIME}
    found = Envelope(largest, runs, asked.get(BENCH_TIME, float(round(_TIME_ROOM * runs * run_s))))
    beyond = found.beyond(peaks)
    if beyond:
        raise BadInputError(
            f"the plan with its own controller would leave the envelope: {beyond}",
            where="--envelope",
            fix="widen the envelope, or give a plan with lower values",
        )
    if found.bench_time_s < run_s:
        raise BadInputError(
            f"one run takes {run_s:.0f} s, the envelope has {found.bench_time_s:.0f} s",
            where="--envelope",
            fix=f"give {BENCH_TIME} of at least {run_s:.0f}",
        )
    return found


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
