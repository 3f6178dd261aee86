"""Refining where it is measured: on a bench whose axle the model does not know."""

import numpy as np
import pytest

from hil.analysis.tuning import Effort, Measured, RefinementBudget, Space, refine, tune, values_of
from hil.core.model import EffectUse
from tests.hil.analysis.tuning.trials import LET_GO, MODEL, trial_of

# How it refines, with everything let go that a tuning keeps.
FREE = f"""
[free]
lead_deg = [0.0, 75.0]
feed_forward_time_s = [0.03, 0.2]
{LET_GO}
"""
OTHER = MODEL.with_parameters(torque_delay=0.012).with_effects(
    *MODEL.effects, EffectUse("backlash", {"half_gap_rad": 0.02})
)


class ComputedBench:
    """Another axle under the same plan; `refuses` the runs with these numbers."""

    def __init__(self, trial, model, refuses=(), fails=()):
        self._trial, self._model, self._refuses, self._fails = trial, model, refuses, fails
        self.asked, self.runs = 0, []

    def refused(self, controller):
        self.asked += 1
        return "beyond the envelope" if self.asked in self._refuses else ""

    def run(self, controller, number):
        self.runs.append(controller)
        if number in self._fails:
            return Measured(trouble="a limit tripped")
        return Measured(self._trial.judged(self._trial.execute(self._model, controller, 0.0, 0)))


@pytest.fixture(scope="module")
def trial():
    return trial_of(FREE)


def refined(trial, bench, start=None, **options):
    space = Space(trial.free.free)
    point = space.point(values_of(trial.start)) if start is None else start
    return refine(trial, space, point, bench, processes=1, **options)


def test_a_few_runs_gain_margin_on_an_axle_that_the_model_does_not_know(trial):
    bench = ComputedBench(trial, OTHER)
    found = refined(trial, bench, budget=RefinementBudget(runs=8))
    first = found.runs[0]
    assert first.decision == "first"
    assert found.best is not None
    assert found.best.worst > first.worst + 0.01
    assert found.best.worst == max(run.worst for run in found.runs)
    assert len(bench.runs) == len(found.runs) <= 8
    for run in found.runs[1:]:
        point = Space(trial.free.free).point(run.values)
        before = max(found.runs[: run.number - 1], key=lambda one: one.worst)
        away = np.abs(point - Space(trial.free.free).point(before.values))
        assert np.max(away) <= run.radius + 1e-9
        assert run.reason
    assert found.ended


def test_what_a_run_has_shown_is_expected_of_the_next_one(trial):
    found = refined(trial, ComputedBench(trial, OTHER), budget=RefinementBudget(runs=2))
    first, second = found.runs
    apart = {name: first.measured[name] - first.predicted.margins[name] for name in first.measured}
    for name, more in apart.items():
        assert second.expected[name] == pytest.approx(second.predicted.margins[name] + more)
    assert found.ended == "all runs are complete"


def test_on_the_model_itself_nothing_is_gained_after_a_search(trial):
    search = tune(trial, effort=Effort(starts=2), processes=1)
    space = Space(trial.free.free)
    bench = ComputedBench(trial, MODEL)
    found = refined(trial, bench, space.point(search.chosen.values), budget=RefinementBudget(least_gain=0.01))
    assert found.runs[0].worst == pytest.approx(search.chosen.worst.worst, abs=1e-6)
    assert len(found.runs) == 1
    assert "no further improvement predicted" in found.ended


def test_hard_limits_hold_on_every_car():
    text = f"{FREE}[limits]\nphase_margin_deg = 45.0\n[tolerance]\ndead_time_s = 0.006\n"
    trial = trial_of(text, draws=3)
    found = refined(trial, ComputedBench(trial, OTHER), budget=RefinementBudget(runs=4))
    alone = refined(trial_of(text), ComputedBench(trial, OTHER), budget=RefinementBudget(runs=4))
    assert len(found.runs) > 1
    assert all(trial.tried(run.values, car).feasible for run in found.runs for car in range(4))
    worst = [min(trial.tried(run.values, car).worst for car in range(1, 4)) for run in found.runs]
    assert min(worst) >= worst[0] - 1e-3
    assert not all(trial.tried(run.values, car).feasible for run in alone.runs for car in range(4))


def test_a_first_run_that_is_not_as_predicted_is_the_last_where_that_is_asked_for(trial):
    found = refined(trial, ComputedBench(trial, OTHER), budget=RefinementBudget(stop_beyond=0.001))
    assert len(found.runs) == 1
    assert "deviates from its prediction" in found.ended
    assert found.best is found.runs[0]


def test_what_is_refused_is_not_run_and_the_best_is_kept(trial):
    bench = ComputedBench(trial, OTHER, refuses=(2,))
    found = refined(trial, bench)
    assert [run.decision for run in found.runs] == ["first", "refused"]
    assert len(bench.runs) == 1
    assert found.ended == "beyond the envelope"
    assert found.best is found.runs[0]


def test_a_run_that_fails_is_the_last(trial):
    found = refined(trial, ComputedBench(trial, OTHER, fails=(1,)))
    assert [run.decision for run in found.runs] == ["failed"]
    assert (found.best, found.ended) == (None, "a limit tripped")


def test_it_stops_when_somebody_asks_and_keeps_what_was_measured(trial):
    bench = ComputedBench(trial, OTHER)
    found = refined(trial, bench, stopped=lambda: len(bench.runs) > 0)
    assert (len(found.runs), found.ended) == (1, "stopped")
