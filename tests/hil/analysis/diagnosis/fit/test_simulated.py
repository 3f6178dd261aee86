"""What a hypothesis shows, from the initial values that suit it."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from hil.analysis.diagnosis.data.noise import noise_levels
from hil.analysis.diagnosis.data.trace import trace_of
from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.fit.problem import MOTOR, WHEEL, Problem, problem_of
from hil.analysis.diagnosis.fit.simulated import creeping, settled_starts, simulated_samples
from hil.core.channels import INPUT, OUTPUTS, TIME
from hil.core.recording import Recording
from hil.plant import Start, simulate
from tests.hil.analysis.diagnosis.one_recording import MODEL, NOISE, one_problem, one_trace

RATIO = MODEL.parameters["gear_ratio"]


def test_settled_starts_undo_a_wrong_one() -> None:
    problem, hypothesis = one_problem(), Hypothesis(MODEL)
    theta = hypothesis.start()
    wrong = [problem.first_starts()[0] + np.array([30.0, 3.0, 50.0, 0.0, 0.0])]
    settled = settled_starts(problem, hypothesis, theta, wrong)
    error = simulated_samples(problem, hypothesis, theta, settled)[0] - problem.traces[0].samples
    assert np.std(error, axis=0) == pytest.approx(NOISE, rel=0.1)


def _begun(wheel_speed: float) -> Problem:
    """An axle that turns already when nothing is asked for yet, by less than a sample's noise."""
    rng = np.random.default_rng(2)
    time = np.arange(0.0, 4.0, 1e-3)
    torque = np.where(time < 0.1, 0.0, 20.0 * np.sin(2 * np.pi * 3.0 * (time - 0.1)))
    clean = simulate(MODEL, torque, 1e-3, start=Start(RATIO * wheel_speed, wheel_speed))
    channels = {TIME: time, INPUT: torque}
    for name, level in zip(OUTPUTS, NOISE, strict=True):
        channels[name] = clean[name] + rng.normal(0.0, level, len(time))
    traces = [trace_of(Recording(channels, Path("creep.csv")))]
    return problem_of(traces, noise_levels(traces), RATIO)


def test_an_axle_at_rest_may_creep_by_what_its_first_samples_cannot_tell_from_rest() -> None:
    problem, hypothesis = _begun(0.5 * NOISE[1]), Hypothesis(MODEL)
    assert problem.resting == (True,)
    (start,) = settled_starts(problem, hypothesis, hypothesis.start(), problem.first_starts())
    assert start[WHEEL] == pytest.approx(0.5 * NOISE[1], rel=0.1)
    assert start[MOTOR] == pytest.approx(RATIO * start[WHEEL])
    error = simulated_samples(problem, hypothesis, hypothesis.start(), [start])[0] - problem.traces[0].samples
    assert np.sqrt(np.mean(error**2, axis=0)) == pytest.approx(NOISE, rel=0.05)


def test_an_axle_that_begins_at_rest_is_held_there_by_a_model_that_fits_badly() -> None:
    """A speed of its own at the start would hide part of what the model misses."""
    problem = one_problem()
    assert problem.resting == (True,)
    heavier = MODEL.with_parameters(vehicle_inertia=1.5 * MODEL.parameters["vehicle_inertia"])
    hypothesis = Hypothesis(heavier)
    (start,) = settled_starts(problem, hypothesis, hypothesis.start(), problem.first_starts())
    slowest, fastest = creeping(problem, 0)
    assert -3.0 * NOISE[1] < slowest <= start[WHEEL] <= fastest < 3.0 * NOISE[1]
    assert start[MOTOR] == pytest.approx(RATIO * start[WHEEL])


@pytest.mark.parametrize(
    ("motor", "wheel", "slowest", "fastest"),
    [
        (0.0, 0.0, -0.04, 0.04),  # 4 / sqrt(25) of the wheel's noise; the motor's would allow 0.049
        (0.0, 0.03, -0.01, 0.049),
        (0.0, 0.5, -0.049, 0.049),  # the wheel's sensor has an offset
        (np.nan, 0.01, -0.03, 0.05),
    ],
)
def test_how_fast_it_may_creep(motor: float, wheel: float, slowest: float, fastest: float) -> None:
    trace = replace(one_trace(), start=np.array([motor, wheel, 0.0]), start_samples=25)
    problem = problem_of([trace], np.array([0.5, 0.05, 1.0]), RATIO)
    assert creeping(problem, 0) == pytest.approx((slowest, fastest), abs=2e-4)
