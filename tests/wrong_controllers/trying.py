"""Carries a plan out with a wrong controller, predicted, and says what noticed it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from hil.core.controller import Controller, load_controller
from hil.core.errors import HilError
from hil.core.model import load_model
from hil.core.recording import Recording
from hil.core.result import CriterionResult, Segment
from hil.engine import load_bench
from hil.engine.bench.ranges import limits_of_channels
from hil.engine.prediction.batch_prediction import BatchPrediction, controller_files
from hil.engine.prediction.prediction import Prediction
from hil.plant.closed_loop import TICK_S
from test_plans import Plan, judge, load_plan
from test_plans.metrics._low_pass import low_passed
from tests.wrong_controllers.mutants import Mutant, mutants_of

_T_S = "shaft_torque_nm"
_LASTING_HZ = 4.0
MOVED_SHARE = 0.1  # of the step: what has to be noticed


@dataclass(frozen=True)
class Tried:
    """What became of a mutant: how far it moved T_s, share of the step, at once and below 4 Hz."""

    file: str
    mutant: Mutant
    moved: float
    lasting: float
    noticed: tuple[str, ...]
    response_s: float = np.nan
    arrival_percent: float = np.nan
    line_nm: float = np.nan

    @property
    def escapes(self) -> bool:
        """Whether it moves T_s by more than a tenth of the step, and nothing notices."""
        return self.moved > MOVED_SHARE and not self.noticed


@dataclass(frozen=True)
class Stage:
    """A plan on the simulated bench."""

    plan: Plan

    @classmethod
    def of(cls, name: str) -> Stage:
        return cls(load_plan(name))

    @cached_property
    def _bench(self):  # type: ignore[no-untyped-def]
        return load_bench("sim")

    @cached_property
    def files(self) -> tuple[Path, ...]:
        """The plan's controller files."""
        return controller_files(self.plan, self._bench)

    def run(self, file: Path, controller: Controller | None) -> Prediction:
        """The plan predicted with a controller in place of `file`."""
        runs = BatchPrediction(self.plan, self._bench, file, frozenset())
        assert self._bench.simulation is not None
        return runs(load_model(self._bench.simulation.model), controller, 0.0, 0, whole=True)

    def all_mutants(self, kept: str = "") -> Iterator[Tried]:
        """Each mutant of each controller file of the plan, tried; `kept`: those whose path has this text."""
        for file in self.files:
            own = self.run(file, None)
            controller = load_controller(file)
            others = [load_controller(one) for one in self.files if one != file] or [controller]
            for mutant in mutants_of(controller, others[0]):
                if kept in mutant.what:
                    yield self.tried(file, mutant, own)

    def tried(self, file: Path, mutant: Mutant, own: Prediction) -> Tried:
        """One mutant beside the right controller."""
        if mutant.controller is None:
            return Tried(file.stem, mutant, 0.0, 0.0, ("refused: the file",))
        try:
            found = self.run(file, mutant.controller)
        except HilError as error:
            return Tried(file.stem, mutant, np.inf, np.inf, (f"refused: {error.what}",))
        judged = judge(self.plan, found.recording, found.segments, measured=False)
        return Tried(
            file.stem,
            mutant,
            *_moved(own, found),
            tuple(self._noticed(found, judged)),
            _worst(judged, "response_time"),
            _worst(judged, "arrival"),
            _worst(judged, "stability_oscillation"),
        )

    def noticed(self, found: Prediction) -> tuple[str, ...]:
        """What refuses a run, by name."""
        judged = judge(self.plan, found.recording, found.segments, measured=False)
        return tuple(self._noticed(found, judged))

    def _noticed(self, found: Prediction, judged: tuple[CriterionResult, ...]) -> Iterator[str]:
        for one in judged:
            if one.failed or one.verdict == "error":
                yield one.id
        limits = limits_of_channels(self._bench.limits)
        for channel, limit in limits.items():
            if found.peaks[channel] > limit:
                yield f"limit {channel}"


def _worst(judged: tuple[CriterionResult, ...], metric: str) -> float:
    """The largest magnitude of a metric over the segments."""
    values = [abs(c.value) for c in judged if c.value is not None and c.id.endswith(f".{metric}")]
    return max(values, default=np.nan)


def _moved(own: Prediction, found: Prediction) -> tuple[float, float]:
    """Largest change of T_s within a segment after its step, and of T_s below 4 Hz, shares of the step."""
    others: Mapping[str, Segment] = {segment.id: segment for segment in found.segments}
    at_once, lasting = [], []
    for segment in own.segments:
        size = abs(segment.reference_after - segment.reference_before)
        mine = _after(own.recording, segment)
        theirs = _after(found.recording, others[segment.id])
        count = min(len(mine), len(theirs))
        change = mine[:count] - theirs[:count]
        at_once.append(float(np.max(np.abs(change))) / size)
        lasting.append(float(np.max(np.abs(low_passed(change, _LASTING_HZ, TICK_S)))) / size)
    return max(at_once), max(lasting)


def _after(recording: Recording, segment: Segment) -> np.ndarray:
    first = round((segment.step_s - recording.first_s) / TICK_S)
    last = round((segment.end_s - recording.first_s) / TICK_S)
    return recording[_T_S][first:last]
