"""When a hypothesis earns its further names, and a whole search on little data."""

import numpy as np
import pytest

from hil.analysis.diagnosis.data.noise import noise_levels
from hil.analysis.diagnosis.data.trace import trace_of
from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.fit.fit import fit
from hil.analysis.diagnosis.fit.problem import problem_of
from hil.analysis.diagnosis.search.race import Step, grown, race
from hil.analysis.diagnosis.search.screen import Score
from hil.analysis.diagnosis.search.search import begin_search, earned, finished, following, search, worth_care
from hil.analysis.diagnosis.search.thresholds import FAR
from hil.core.channels import OUTPUTS, TIME
from hil.core.model import EffectUse
from tests.hil.analysis.diagnosis.one_recording import MODEL, left, one_problem, recorded

OFFSET = EffectUse("sensor_offset", {"channel": OUTPUTS[2], "offset": 20.0})
LAG = EffectUse("actuator_lag", {"time_constant_s": 0.01})
POOR, RICH = left(300.0), left(200.0, LAG)


class Told:
    """Evidence that says what a table says."""

    def __init__(self, drop: float, whole: float, closed: float) -> None:
        self.drop, self.whole, self.closed = drop, whole, closed

    def between(self, poorer: object, richer: object) -> float:
        return self.drop

    def left(self, one: object) -> float:
        return 1.0 - self.closed if one is RICH else 1.0

    def share(self, one: object) -> float:
        return self.whole


@pytest.mark.parametrize(
    ("drop", "whole", "closed", "earns"),
    [
        (31.0, 0.0, 0.61, True),
        (29.0, 0.0, 0.99, False),  # too little evidence
        (31.0, 0.0, 0.59, False),  # too small a share of the gap
        (31.0, 0.94, 0.87, False),  # where nearly all was closed before, it must be more
        (31.0, 0.94, 0.89, True),
    ],
)
def test_a_further_name_is_earned(drop: float, whole: float, closed: float, earns: bool) -> None:
    assert earned(Told(drop, whole, closed), POOR, RICH) is earns  # type: ignore[arg-type]


DELAY = EffectUse("dead_time", {"extra_delay_s": 0.008})
SKEW = EffectUse("channel_skew", {"channel": OUTPUTS[0], "delay_s": 0.008})


@pytest.mark.parametrize(("total", "kept"), [(1.2 * FAR, True), (0.8 * FAR, False)])
def test_where_formulas_differ_sensors_do_not_take_the_place_of_what_led(total: float, kept: bool) -> None:
    led, first, second = (left(total * POOR.rows, *uses) for uses in ((DELAY,), (SKEW, LAG), (DELAY, SKEW)))
    assert following(led, [first, second]) is (second if kept else first)
    assert following(led, [first]) is first  # nothing keeps its names


def test_a_hidden_offset_is_found_alone() -> None:
    found = search(one_problem(OFFSET), Hypothesis(MODEL), lambda text: None)
    assert found.best.hypothesis.keys == (("sensor_offset", OUTPUTS[2]),)
    assert found.evidence.closed(found.best)


def test_an_effect_is_grown_from_its_best_size() -> None:
    problem = one_problem(LAG)
    base = search(one_problem(), Hypothesis(MODEL), lambda text: None).base
    one = grown(problem, base, EffectUse("actuator_lag", {"time_constant_s": 0.007}), 3)
    assert np.exp(one.theta[-1]) == pytest.approx(0.01, rel=0.2)


@pytest.mark.parametrize(("beyond", "steps"), [(5900.0, 2), (6100.0, 1)])
def test_only_what_is_not_far_behind_is_fitted_with_care(beyond: float, steps: int) -> None:
    problem = one_problem(LAG)
    near, far = (left(problem.rows + more, use) for more, use in ((2000.0, LAG), (beyond, DELAY)))
    raced = [Step(POOR, [], [far]), Step(POOR, [], []), Step(POOR, [], [near])]
    worth = worth_care(problem, raced)
    assert [step.fits[0] for step in worth] == [near, far][:steps]


def test_effects_that_were_fitted_beside_another_parent_are_not_fitted_again() -> None:
    problem = one_problem(LAG)
    base = search(one_problem(), Hypothesis(MODEL), lambda text: None).base
    beside_lag = grown(problem, base, LAG, 3)
    both = grown(problem, beside_lag, OFFSET, 3)
    step = Step(grown(problem, base, OFFSET, 3), [Score(LAG, 1e6)], [])
    race(problem, step, [both])
    assert step.fits == []
    race(problem, step)
    assert [frozenset(one.hypothesis.keys) for one in step.fits] == [frozenset(both.hypothesis.keys)]


@pytest.mark.parametrize("first", [True, False])
def test_what_promises_most_is_not_given_up_while_it_falls(first: bool) -> None:
    """Free numbers made up for a lag: beside them its true size is far off, until they have found back."""
    lag = EffectUse("actuator_lag", {"time_constant_s": 0.004})
    problem = one_problem(lag)
    step = Step(fit(problem, Hypothesis(MODEL, far=True)), [Score(lag, 2e6), Score(OFFSET, 1e6)], [])
    if not first:
        step.scores.reverse()
    race(problem, step, [left(1.05 * problem.rows, rows=problem.rows)])
    found = next(one for one in step.fits if one.hypothesis.ids == ("actuator_lag",))
    assert (found.total < 1.2 * problem.rows) is first
    assert (found.total > 10.0 * problem.rows) is not first


def test_what_was_left_out_for_an_effect_that_is_not_found_is_judged_after_all() -> None:
    """Errors in the half that is left out alone: to see nothing in the other half is a false calm."""
    one = recorded(seconds=8.0)
    shaft = one.channels[OUTPUTS[2]]
    shaft += np.where(one.channels[TIME] < 3.0, 20.0, 0.0)
    traces = [trace_of(one)]
    whole = problem_of(traces, noise_levels(one_problem().traces), MODEL.parameters["gear_ratio"])
    blocks = len(traces[0].measured)
    half = whole.judging([np.arange(blocks) > blocks // 2])
    found = begin_search(half, fit(half, Hypothesis(MODEL)))
    assert found.settled  # with nothing named: this would be the answer
    told: list[str] = []
    after = finished(found, told.append)
    assert told[0] == "using all parts of the recordings"
    assert after.evidence.problem.rows == whole.rows
    assert not after.evidence.closed(after.base)
