"""Width of a play whose first place nobody knows: told as far as reversals tell it."""

from pathlib import Path

import numpy as np
import pytest

from hil.analysis.diagnosis.data.noise import noise_levels
from hil.analysis.diagnosis.data.trace import trace_of
from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.fit.covariance import standard_errors
from hil.analysis.diagnosis.fit.fit import Fit, fit
from hil.analysis.diagnosis.fit.problem import Problem, problem_of
from hil.analysis.diagnosis.search.evidence import Evidence
from hil.analysis.diagnosis.search.places import placed
from hil.core.channels import INPUT, OUTPUTS, TIME
from hil.core.model import EffectUse
from hil.core.recording import Recording
from hil.plant import Start, simulate
from tests.hil.analysis.diagnosis.one_recording import MODEL
from tests.hil.analysis.diagnosis.reference_plant import BASE

HALF_GAP = 0.02
SETTLED = 500  # samples in which what the plant's start twists the tyre by is gone: the axle rests
LAG = EffectUse("actuator_lag", {"time_constant_s": 0.01})


def _problem(torque: np.ndarray) -> Problem:
    """An axle with play, at rest half way from its middle to a flank, then `torque`."""
    rng = np.random.default_rng(1)
    channels = {TIME: np.arange(len(torque)) * 1e-3, INPUT: torque}
    model = MODEL.with_effects(EffectUse("backlash", {"half_gap_rad": HALF_GAP}))
    before = np.full(SETTLED, torque[0])
    clean = simulate(model, np.concatenate([before, torque]), 1e-3, start=Start(0.0, 0.0, 1.0))
    for name, noise in zip(OUTPUTS, (0.02, 0.0014, 0.7), strict=True):
        channels[name] = clean[name][SETTLED:] + rng.normal(0.0, noise, len(torque))
    traces = [trace_of(Recording(channels, Path("play.csv")))]
    return problem_of(traces, noise_levels(traces), BASE["gear_ratio"])


def _from(problem: Problem, half_gap: float) -> tuple[Evidence, Fit]:
    stuck = fit(problem, Hypothesis(MODEL, (EffectUse("backlash", {"half_gap_rad": half_gap}),)))
    return Evidence(problem, fit(problem, Hypothesis(MODEL))), stuck


@pytest.mark.parametrize("first", [0.013, 0.02])
def test_a_play_crossed_once_is_told_with_the_scatter_of_what_explains_as_much(first: float) -> None:
    problem = _problem(np.where(np.arange(3000) < 300, 0.0, 60.0))
    evidence, stuck = _from(problem, first)
    found = placed(evidence, stuck)
    error = float(standard_errors(problem, found)[-1])
    way = HALF_GAP - 0.5 * HALF_GAP  # all that is seen: told as half a play that begins in its middle
    assert np.exp(found.theta[-1]) == pytest.approx(way, rel=0.05)
    assert abs(found.theta[-1] - np.log(HALF_GAP)) < 2.0 * error


def test_reversals_tell_the_width_whatever_the_first_place() -> None:
    steps = 60.0 * np.sign(np.sin(2 * np.pi * np.arange(3000) / 700.0))
    evidence, stuck = _from(_problem(steps), 0.016)
    found = placed(evidence, stuck)
    assert np.exp(found.theta[-1]) == pytest.approx(HALF_GAP, rel=0.01)
    assert float(standard_errors(evidence.problem, found)[-1]) < 0.01


def test_the_right_width_begun_in_a_wrong_place_is_begun_elsewhere() -> None:
    problem = _problem(60.0 * np.sign(np.sin(2 * np.pi * np.arange(3000) / 700.0)))
    evidence, right = _from(problem, HALF_GAP)
    wrong = [start + np.array([0.0, 0.0, 40.0, 0.0, 0.0]) for start in right.starts]
    stuck = fit(problem, right.hypothesis, wrong, right.theta, rounds=0)
    assert stuck.total > 20.0 * right.total
    assert placed(evidence, stuck).total < 1.1 * right.total


def test_what_remembers_no_place_is_left_as_it_is() -> None:
    problem = _problem(np.full(500, 10.0))
    one = fit(problem, Hypothesis(MODEL, (LAG,)), rounds=0)
    assert placed(Evidence(problem, one), one) is one
