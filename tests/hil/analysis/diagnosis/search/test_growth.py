"""One step of a search: what is tried beside a hypothesis, and which of it comes first."""

from __future__ import annotations

import pytest

from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.fit.fit import fit
from hil.analysis.diagnosis.search.evidence import Evidence
from hil.analysis.diagnosis.search.growth import grow
from hil.analysis.diagnosis.search.race import Step
from hil.analysis.diagnosis.search.screen import Score
from hil.core.channels import OUTPUTS
from hil.core.model import EffectUse
from tests.hil.analysis.diagnosis.one_recording import MODEL, one_problem

OFFSET = EffectUse("sensor_offset", {"channel": OUTPUTS[2], "offset": 20.0})
GAIN = EffectUse("sensor_gain", {"channel": OUTPUTS[0], "gain": 1.01})


def test_what_explains_most_comes_first_and_what_promises_nothing_is_not_fitted() -> None:
    problem = one_problem(OFFSET)
    base = fit(problem, Hypothesis(MODEL))
    step = Step(base, [], [])
    grow(Evidence(problem, base), step)
    assert step.fits[0].hypothesis.keys == (("sensor_offset", OUTPUTS[2]),)
    assert [one.total for one in step.fits] == sorted(one.total for one in step.fits)
    tried = {one.hypothesis.keys[-1] for one in step.fits}
    assert tried < {score.key for score in step.scores}


@pytest.mark.parametrize(("share", "fitted"), [(0.2, False), (0.6, True)])
def test_beside_an_effect_that_was_found_a_second_has_to_promise_more(share: float, fitted: bool) -> None:
    problem = one_problem(OFFSET)
    evidence = Evidence(problem, fit(problem, Hypothesis(MODEL), rounds=1))
    step = Step(fit(problem, Hypothesis(MODEL, (GAIN,)), rounds=1), [], [])
    blocks = problem.rows / problem.channels
    promised = Score(OFFSET, share * evidence.left(step.parent) * blocks)
    rival = fit(problem, Hypothesis(MODEL, (OFFSET,)))  # explains all: nothing else is looked for
    grow(evidence, step, [promised], rivals=[rival], everywhere=True)
    assert bool(step.fits) is fitted
