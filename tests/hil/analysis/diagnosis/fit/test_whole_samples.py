"""A rigid axle shows its dead time by whole samples: fits cross them."""

import numpy as np
import pytest

from hil.analysis.diagnosis.data.noise import noise_levels
from hil.analysis.diagnosis.data.trace import trace_of
from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.fit.fit import Fit, fit
from hil.analysis.diagnosis.fit.problem import Problem, problem_of
from hil.analysis.diagnosis.fit.whole_samples import delay_by_samples
from hil.core.channels import INPUT, OUTPUTS, TIME
from hil.core.model import EffectUse, Model
from hil.core.recording import Recording
from hil.plant import simulate

PARAMETERS = {
    "motor_inertia": 0.02,
    "gear_ratio": 10.0,
    "vehicle_inertia": 300.0,
    "viscous_drag": 0.002,
    "torque_delay": 0.00805,
}
MODEL = Model("rigid", PARAMETERS)
SHAFT = OUTPUTS[2]


@pytest.fixture
def fitted(tmp_path):
    """Fits a hypothesis to what a true model shows."""

    def run(true: Model, hypothesis: Hypothesis) -> tuple[Problem, Fit]:
        rng = np.random.default_rng(2)
        time = np.arange(0.0, 12.0, 1e-3)
        torque = 20.0 * np.sin(2 * np.pi * (0.2 * time + 0.8 * time**2))
        clean = simulate(true, torque, 1e-3)
        channels = {TIME: time, INPUT: torque}
        for name, noise in zip(OUTPUTS, (0.5, 0.05, 1.0), strict=True):
            channels[name] = clean[name] + rng.normal(0.0, noise, len(time))
        traces = [trace_of(Recording(channels, tmp_path / "one.csv"))]
        problem = problem_of(traces, noise_levels(traces), PARAMETERS["gear_ratio"])
        return problem, fit(problem, hypothesis)

    return run


def test_a_dead_time_just_across_a_sample_is_found(fitted):
    problem, one = fitted(MODEL.with_parameters(torque_delay=0.00795), Hypothesis(MODEL))
    assert one.cost == pytest.approx(problem.rows, rel=0.05)
    assert one.hypothesis.model(one.theta).parameters["torque_delay"] < 0.008


@pytest.mark.parametrize("start", [0.0001, 0.002, 0.0055])
def test_an_extra_dead_time_of_some_samples_is_found_from_anywhere(fitted, start):
    extra = EffectUse("dead_time", {"extra_delay_s": 0.0034})
    guess = EffectUse("dead_time", {"extra_delay_s": start})
    problem, one = fitted(MODEL.with_effects(extra), Hypothesis(MODEL, (guess,)))
    assert one.cost == pytest.approx(problem.rows, rel=0.05)
    found = one.hypothesis.model(one.theta).effects[0].values["extra_delay_s"]
    assert np.floor((found + 0.00805) * 1e3) == np.floor((0.0034 + 0.00805) * 1e3)


def test_a_late_channel_makes_up_for_a_sample(fitted):
    late = EffectUse("channel_skew", {"channel": SHAFT, "delay_s": 0.0032})
    guess = EffectUse("channel_skew", {"channel": SHAFT, "delay_s": 0.001})
    true = MODEL.with_parameters(torque_delay=0.00795).with_effects(late)
    problem, one = fitted(true, Hypothesis(MODEL, (guess,)))
    assert one.cost == pytest.approx(problem.rows, rel=0.05)


def test_descents_stay_within_their_sample():
    hypothesis = Hypothesis(MODEL)
    by_samples = delay_by_samples(hypothesis, 1e-3)
    assert by_samples is not None
    theta = hypothesis.start()
    wide = np.full(len(theta), 1.0)
    lower, upper = by_samples.within(theta, -wide, wide)
    ends = [hypothesis.model(end).parameters["torque_delay"] for end in (lower, upper)]
    assert 0.008 < ends[0] < ends[1] < 0.009
    leapt = [hypothesis.model(t).parameters["torque_delay"] for t in by_samples.leaps(theta, -wide, wide)]
    assert [int(delay * 1e3) for delay in leapt] == [7]  # others are beyond the calibration tolerance


def test_dead_time_as_an_effect_leaps_to_any_sample_near():
    hypothesis = Hypothesis(MODEL, (EffectUse("dead_time", {"extra_delay_s": 0.0101}),))
    by_samples = delay_by_samples(hypothesis, 1e-3)
    assert by_samples is not None
    theta = hypothesis.start()
    wide = np.full(len(theta), 1.0)
    leapt = [
        hypothesis.model(t).effects[0].values["extra_delay_s"] for t in by_samples.leaps(theta, -wide, wide)
    ]
    assert sorted(int((float(delay) + 0.00805) * 1e3) - 18 for delay in leapt) == [-4, -3, -2, -1, 1, 2, 3, 4]


def test_models_with_springs_have_no_such_steps():
    springs = {"shaft_stiffness": 6000.0, "shaft_damping": 20.0}
    assert delay_by_samples(Hypothesis(Model("two_inertia", {**PARAMETERS, **springs})), 1e-3) is None


def test_a_skew_of_just_a_sample_costs_more_than_dead_time(fitted):
    true = MODEL.with_effects(EffectUse("dead_time", {"extra_delay_s": 0.0014}))  # crosses one sample
    guesses = (
        EffectUse("channel_skew", {"channel": SHAFT, "delay_s": 0.0007}),
        EffectUse("dead_time", {"extra_delay_s": 0.0007}),
    )
    skew, late = (fitted(true, Hypothesis(MODEL, (use,)))[1] for use in guesses)
    assert skew.theta[-1] == pytest.approx(0.001, abs=2e-5)
    assert late.total < skew.total


def test_a_fit_begun_where_another_ended_ends_at_once(fitted):
    problem, one = fitted(MODEL, Hypothesis(MODEL))
    again = fit(problem, one.hypothesis, one.starts, one.theta)
    assert again.rounds == 0
    assert again.total == pytest.approx(one.total)


@pytest.mark.parametrize(("delay", "start"), [(0.00786, 0.0004), (0.00815, 0.0004), (0.00786, 0.002)])
def test_beside_a_lag_a_dead_time_is_found_across_a_sample(fitted, delay, start):
    """At a whole sample its slope bends: a descent that ends there begins again on either side."""
    lag, guess = (EffectUse("actuator_lag", {"time_constant_s": value}) for value in (0.0007, start))
    true = MODEL.with_parameters(torque_delay=delay).with_effects(lag)
    base = MODEL.with_parameters(torque_delay=0.008)
    problem, one = fitted(true, Hypothesis(base, (guess,)))
    assert one.cost == pytest.approx(problem.rows, rel=0.05)
    found = one.hypothesis.model(one.theta)
    assert found.effects[0].values["time_constant_s"] == pytest.approx(0.0007, rel=0.1)
    assert found.parameters["torque_delay"] == pytest.approx(delay, abs=5e-5)


def test_without_a_lag_no_descent_begins_again():
    by_samples = delay_by_samples(Hypothesis(MODEL.with_parameters(torque_delay=0.008)), 1e-3)
    assert by_samples is not None
    theta = by_samples.hypothesis.start()
    wide = np.full(len(theta), 1.0)
    assert by_samples.beside_bend(theta, -wide, wide) == []
