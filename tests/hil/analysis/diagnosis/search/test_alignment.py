"""Ripples follow a measured angle that drifts: the ripple itself tells how."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.signal import lfilter

from hil.analysis.diagnosis.data.noise import noise_levels
from hil.analysis.diagnosis.data.trace import Trace, trace_of
from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.fit.fit import fit
from hil.analysis.diagnosis.fit.problem import Problem, problem_of
from hil.analysis.diagnosis.search.alignment import aligned, with_base_angles
from hil.analysis.diagnosis.search.screen import screen
from hil.analysis.diagnosis.search.tracking import track, tracked_gain
from hil.core.channels import INPUT, OUTPUTS, TIME
from hil.core.model import EffectUse, Model
from hil.core.recording import Recording
from hil.plant import Start, simulate
from tests.hil.analysis.diagnosis.reference_plant import BASE

MODEL = Model("three_inertia", dict(BASE))
RIPPLE = EffectUse("motor_order_ripple", {"order": 4.0, "amplitude_nm": 0.7, "phase_rad": 1.0})


def recorded(ripple: EffectUse, path: Path, speed_noise: float = 1.0, slow: float = 0.0) -> Problem:
    """One recording with a noisy motor speed; `slow`: standard deviation of its noise that drifts slowly."""
    rng = np.random.default_rng(4)
    time = np.arange(0.0, 20.0, 1e-3)
    torque = 12.0 + 8.0 * np.sin(2 * np.pi * (0.3 * time + 0.05 * time**2))
    clean = simulate(MODEL.with_effects(ripple), torque, 1e-3)
    channels = {TIME: time, INPUT: torque}
    for name, noise in zip(OUTPUTS, (speed_noise, 0.1, 1.0), strict=True):
        channels[name] = clean[name] + rng.normal(0.0, noise, len(time))
    wander = lfilter([np.sqrt(1.0 - 0.998**2)], [1.0, -0.998], rng.normal(0.0, slow, len(time)))
    channels[OUTPUTS[0]] = channels[OUTPUTS[0]] + wander
    traces = [trace_of(Recording(channels, path / "one.csv"))]
    return problem_of(traces, noise_levels(traces), BASE["gear_ratio"])


@pytest.fixture
def problem(tmp_path) -> Problem:
    return recorded(RIPPLE, tmp_path)


def test_the_drift_of_the_angle_is_found_with_the_ripple(problem):
    first = problem.angles[0].copy()
    before = fit(problem, Hypothesis(MODEL, (RIPPLE,)))
    after = aligned(problem, before)
    assert before.cost > 1.3 * problem.rows
    assert after.cost - problem.rows < 0.3 * (before.cost - problem.rows)
    found = after.hypothesis.model(after.theta).effects[-1].values
    assert found["amplitude_nm"] == pytest.approx(0.7, rel=0.05)
    assert np.ptp(after.angles[0][:, 1] - first[:, 1]) > 0.05
    assert np.all(after.angles[0][:, 0] == first[:, 0])
    assert np.all(problem.angles[0] == first)


def test_without_a_ripple_nothing_is_moved(problem):
    first = problem.angles[0]
    one = fit(problem, Hypothesis(MODEL), rounds=1)
    assert aligned(problem, one) is one
    assert problem.angles[0] is first


HIGH = EffectUse("motor_order_ripple", {"order": 12.0, "amplitude_nm": 0.7, "phase_rad": 1.0})


@pytest.mark.slow
def test_a_phase_that_wanders_by_turns_is_followed(tmp_path):
    problem = recorded(HIGH, tmp_path, slow=0.5)
    measured = problem.angles[0][:, 1].copy()
    before = fit(problem, Hypothesis(MODEL, (HIGH,)))
    after = aligned(problem, before)
    values = after.hypothesis.model(after.theta).effects[-1].values
    assert values["amplitude_nm"] == pytest.approx(0.7, rel=0.02)
    assert values["order"] == pytest.approx(12.0, abs=0.01)
    assert 12.0 * np.ptp(after.angles[0][:, 1] - measured) > np.pi
    assert before.cost > 5.0 * problem.rows
    assert after.cost < 1.55 * problem.rows  # slow noise stays


def test_an_order_bent_by_drift_is_straightened_to_a_whole_one(tmp_path):
    problem = recorded(RIPPLE, tmp_path)
    bent = EffectUse("motor_order_ripple", {"order": 4.01, "amplitude_nm": 0.7, "phase_rad": 1.0})
    after = aligned(problem, fit(problem, Hypothesis(MODEL, (bent,)), rounds=0))
    assert after.hypothesis.model(after.theta).effects[-1].values["order"] == pytest.approx(4.0, abs=0.003)


def test_known_phase_and_order_are_left_alone(problem):
    hypothesis = Hypothesis(MODEL, (RIPPLE,))
    one = fit(problem, hypothesis, rounds=2)
    theta, _ = track(problem, hypothesis, one.theta, one.starts, order_known=True, phase_known=True)
    assert np.array_equal(theta, one.theta)


@pytest.mark.slow
def test_a_followed_ripple_promises_more_than_one_that_is_not(tmp_path):
    problem = recorded(HIGH, tmp_path, slow=0.5)
    base = fit(problem, Hypothesis(MODEL))
    plain = next(score.gain for score in screen(problem, base) if score.key[0] == HIGH.id)
    assert tracked_gain(problem, base, HIGH) > 1.5 * plain
    closed = base.cost - aligned(problem, fit(problem, Hypothesis(MODEL, (HIGH,)))).cost
    assert tracked_gain(problem, base, HIGH) == pytest.approx(closed, rel=0.1)


def cut_from_motion() -> tuple[Model, Trace]:
    """A model with a ripple, and a recording of it that begins 3 s after the wheels began to turn."""
    ripple = EffectUse("wheel_order_disturbance", {"order": 3.0, "amplitude_nm": 30.0, "phase_rad": 0.0})
    known = MODEL.with_effects(ripple)
    at = np.arange(0.0, 7.0, 1e-3)
    torque = 12.0 + 8.0 * np.sin(2 * np.pi * (0.3 * at + 0.5 * at**2))
    clean = simulate(known, torque, 1e-3, Start(120.0, 120.0 / BASE["gear_ratio"]))
    rng = np.random.default_rng(2)
    channels = {TIME: at[3000:], INPUT: torque[3000:]}
    for name, noise in zip(OUTPUTS, (0.02, 0.0015, 0.7), strict=True):
        channels[name] = clean[name][3000:] + rng.normal(0.0, noise, 4000)
    return known, trace_of(Recording(channels, Path("cut.csv")))


def test_a_ripple_that_the_model_knows_is_followed_from_mid_motion_on():
    known, trace = cut_from_motion()
    problem = problem_of([trace], noise_levels([trace]), BASE["gear_ratio"])
    first = fit(problem, Hypothesis(known))
    assert first.cost > 1000.0 * problem.rows  # nobody knows the wheel's angle where the recording begins
    _, found = with_base_angles(problem, first)
    assert found.cost < 2.0 * problem.rows


@pytest.mark.parametrize("turned_rad", [0.7, 2.5])
def test_where_an_angle_was_not_counted_from_the_models_zero_the_ripple_tells(turned_rad):
    """Who turned the wheels before this run, nobody knows; the recording counts from its own beginning."""
    known, trace = cut_from_motion()
    trace = replace(trace, first_wheel_angle_rad=48.0 + turned_rad)
    problem = problem_of([trace], noise_levels([trace]), BASE["gear_ratio"])
    moved, found = with_base_angles(problem, fit(problem, Hypothesis(known)))
    assert not moved.zero_known
    assert found.cost < 2.0 * problem.rows
