"""Errors and derivatives of a hypothesis over recordings, and that a problem stays as it is."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from hil.analysis.diagnosis.data.trace import trace_of
from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.fit.problem import Problem, problem_of
from hil.analysis.diagnosis.fit.simulated import settled_starts
from hil.core.channels import INPUT, OUTPUTS, TIME
from hil.core.model import EffectUse, Model, parameter_names
from hil.core.recording import Recording
from hil.plant import simulate
from tests.hil.analysis.diagnosis.one_recording import MODEL, NOISE, one_problem, one_trace

RATIO = MODEL.parameters["gear_ratio"]


def moving_problem() -> Problem:
    """The one recording, started in mid-motion."""
    away = dataclasses.replace(one_trace(), start=np.array([100.0, 12.0, 0.0]))
    return problem_of([away], np.array(NOISE), RATIO)


def test_the_true_model_leaves_one_noise_variance_a_row() -> None:
    problem, hypothesis = one_problem(), Hypothesis(MODEL)
    starts = problem.first_starts()
    at = problem.linearised(hypothesis, hypothesis.start(), starts)
    assert at.cost == pytest.approx(problem.rows, rel=0.15)
    costs = problem.costs([hypothesis.packed(hypothesis.start())], [np.stack(starts)])
    assert costs[0] == pytest.approx(at.cost)
    assert at.errors[0].channels.shape == problem.traces[0].measured.shape
    assert at.errors[0].by_coordinate.shape == (problem.rows, len(hypothesis.coordinates()))


def test_a_derivative_is_what_the_error_does() -> None:
    problem, hypothesis = one_problem(), Hypothesis(MODEL)
    theta, starts = hypothesis.start(), problem.first_starts()
    at = problem.linearised(hypothesis, theta, starts)
    index = [c.name for c in hypothesis.coordinates()].index("vehicle_inertia")
    theta[index] += 0.01
    moved = problem.linearised(hypothesis, theta, starts)
    change = at.errors[0].rows - moved.errors[0].rows
    assert change == pytest.approx(0.01 * at.errors[0].by_coordinate[:, index], abs=0.02 * np.ptp(change))


def test_derivatives_are_the_same_where_the_simulation_is_known_already() -> None:
    problem, hypothesis = one_problem(), Hypothesis(MODEL)
    theta, starts = hypothesis.start(), problem.first_starts()
    tried = problem.tried([hypothesis.packed(theta)], [np.stack(starts)])
    anew = problem.linearised(hypothesis, theta, starts)
    known = problem.linearised(hypothesis, theta, starts, [tried.shown[0][0]])
    assert known.cost == anew.cost == pytest.approx(tried.costs[0])
    assert np.array_equal(known.errors[0].by_coordinate, anew.errors[0].by_coordinate)
    assert np.array_equal(known.errors[0].by_start, anew.errors[0].by_start)


def test_a_recording_begins_as_its_plant_can() -> None:
    problem, away = one_problem(), moving_problem()
    chain = Hypothesis(MODEL)
    assert chain.kind == "three_inertia"
    assert problem.free_starts(0, chain) == [0, 1, 2]
    play = Hypothesis(MODEL, (EffectUse("backlash", {"half_gap_rad": 0.01}),))
    for one, with_tyre in ((away, chain), (problem, play)):
        assert one.free_starts(0, with_tyre) == [0, 1, 2, 3, 4]
    for kind, free in (("two_inertia", [0, 1, 2]), ("rigid", [0])):
        model = Model(kind, {name: MODEL.parameters.get(name, 1.0) for name in parameter_names(kind)})
        assert away.free_starts(0, Hypothesis(model)) == free
        shown = away.linearised(Hypothesis(model), Hypothesis(model).start(), away.first_starts())
        assert np.flatnonzero(np.any(shown.errors[0].by_start, axis=0)).tolist() == free


def test_a_channel_that_is_missing_weighs_nothing() -> None:
    trace = one_trace()
    measured = trace.measured.copy()
    measured[:, 2] = np.nan
    problem = problem_of([dataclasses.replace(trace, measured=measured)], np.array(NOISE), RATIO)
    assert problem.weights[0][2] == 0.0
    assert problem.channels == 2
    assert np.all(problem.errors(0, np.zeros_like(measured))[:, 2] == 0.0)


def test_a_simulation_that_diverges_costs_much_and_not_nan() -> None:
    problem = one_problem()
    assert np.all(np.isfinite(problem.errors(0, np.full_like(problem.traces[0].measured, np.nan))))


def test_an_axle_at_rest_is_held_there() -> None:
    problem = one_problem()
    assert problem.resting == (True,)
    assert np.all(problem.start_precision(0)[:2] > 0.0)
    moving = moving_problem()
    assert moving.resting == (False,)
    assert np.all(moving.start_precision(0)[:3] == 0.0)
    assert np.all(moving.start_precision(0)[3:] < 0.1 * problem.start_precision(0)[3:])
    assert moving.first_starts()[0] == pytest.approx([100.0, 12.0, 0.0, 0.0, 0.0])


@pytest.mark.parametrize(
    ("motor_noise", "motor", "wheel", "rests"),
    [
        (0.1, 0.0, 0.0, True),
        (0.1, 0.0, 0.2, True),  # the wheel's sensor has an offset: the motor would show such a motion
        (2.3, 1.0, 0.2, False),  # the motor is too noisy to show it
        (2.3, 1.0, np.nan, True),
        (2.3, 0.0, 0.0, True),
    ],
)
def test_a_noisy_zero_does_not_say_rest_where_the_wheel_turns(
    motor_noise: float, motor: float, wheel: float, rests: bool
) -> None:
    trace = one_trace()
    samples, measured = trace.samples.copy(), trace.measured.copy()
    if np.isnan(wheel):
        samples[:, 1] = measured[:, 1] = np.nan
    started = dataclasses.replace(
        trace,
        samples=samples,
        measured=measured,
        start=np.array([motor, wheel, 0.0]),
        start_samples=20,
    )
    problem = problem_of([started], np.array([motor_noise, 0.08, 1.0]), RATIO)
    assert problem.resting == (rests,)


def test_nothing_of_a_problem_can_be_changed() -> None:
    problem = one_problem()
    with pytest.raises(dataclasses.FrozenInstanceError):
        problem.angles = ()  # type: ignore[misc]
    for shared in (problem.noise, problem.floor, problem.weights[0]):
        with pytest.raises(ValueError, match="read-only"):
            shared[0] = 1.0


def test_other_angles_make_another_problem() -> None:
    problem = one_problem()
    other = problem.with_angles([problem.angles[0] + 1.0])
    assert np.ptp(other.angles[0] - problem.angles[0]) < 1e-9 < other.angles[0][0, 0]
    hypothesis = Hypothesis(MODEL)
    again = other.following(hypothesis, hypothesis.start())
    assert np.array_equal(again.angles[0], problem.angles[0])


def test_noise_that_the_caller_changes_later_does_not_reach_a_problem() -> None:
    noise = np.array(NOISE)
    problem = problem_of([one_trace()], noise, RATIO)
    noise[0] = 99.0
    assert problem.noise[0] == NOISE[0]


def test_torque_from_before_a_recording_in_mid_motion_is_no_error() -> None:
    """Cut where the request jumps, as when a controller takes over: the dead time still knows the old."""
    time = np.arange(0.0, 6.0, 1e-3)
    torque = 10.0 * np.sin(2 * np.pi * 0.5 * time) + np.where((time > 1.0) & (time < 3.0), 6.0, 0.0)
    shown = simulate(MODEL, torque, 1e-3)
    assert MODEL.parameters["torque_delay"] > 0.001
    rng = np.random.default_rng(3)
    noisy = {
        name: shown[name] + rng.normal(0.0, 0.05 * level, 6000)
        for name, level in zip(OUTPUTS, NOISE, strict=True)
    }
    late = {name: values[3000:] for name, values in {TIME: time, INPUT: torque, **noisy}.items()}
    trace = trace_of(Recording(late, Path("cut.csv")))
    problem = problem_of([trace], 0.05 * np.array(NOISE), RATIO)
    assert problem.resting == (False,)
    hypothesis = Hypothesis(MODEL)
    (start,) = settled_starts(problem, hypothesis, hypothesis.start(), problem.first_starts())
    known = problem.linearised(hypothesis, hypothesis.start(), [start])
    assert known.cost == pytest.approx(problem.rows, rel=0.1)
    assert problem.rows == 3 * (len(trace.measured) - 5)
    told = dataclasses.replace(problem, traces=(trace,))  # every sample counts
    (start,) = settled_starts(told, hypothesis, hypothesis.start(), problem.first_starts())
    whole = told.linearised(hypothesis, hypothesis.start(), [start])
    assert whole.cost > 2.0 * told.rows


def test_of_a_short_recording_little_does_not_count() -> None:
    away = dataclasses.replace(one_trace(seconds=0.2), start=np.array([100.0, 12.0, 0.0]))
    (trace,) = problem_of([away], np.array(NOISE), RATIO).traces
    assert trace.lead == 10
    assert np.count_nonzero(~trace.judged_samples) == trace.block * trace.lead_blocks
    assert not one_problem().traces[0].lead  # it begins at rest: there was no torque before
