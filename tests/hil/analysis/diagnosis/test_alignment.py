"""Ripples follow a measured angle that drifts: the ripple itself tells how."""

import numpy as np
import pytest

from hil.analysis.diagnosis._alignment import aligned
from hil.analysis.diagnosis._coordinates import Hypothesis
from hil.analysis.diagnosis._fit import fit
from hil.analysis.diagnosis._problem import Problem
from hil.analysis.diagnosis._trace import noise_levels, trace_of
from hil.core.channels import INPUT, OUTPUTS, TIME
from hil.core.model import EffectUse, Model
from hil.core.recording import Recording
from sim_backend.plant import simulate
from tests.hil.analysis.diagnosis.reference_plant import BASE

MODEL = Model("three_inertia", dict(BASE))
RIPPLE = EffectUse("motor_order_ripple", {"order": 4.0, "amplitude_nm": 0.7, "phase_rad": 1.0})


@pytest.fixture
def problem(tmp_path) -> Problem:
    rng = np.random.default_rng(4)
    time = np.arange(0.0, 20.0, 1e-3)
    torque = 12.0 + 8.0 * np.sin(2 * np.pi * (0.3 * time + 0.05 * time**2))
    clean = simulate(MODEL.with_effects(RIPPLE), torque, 1e-3)
    channels = {TIME: time, INPUT: torque}
    for name, noise in zip(OUTPUTS, (1.0, 0.1, 1.0), strict=True):  # a noisy speed
        channels[name] = clean[name] + rng.normal(0.0, noise, len(time))
    traces = [trace_of(Recording(channels, tmp_path / "one.csv"))]
    return Problem(traces, noise_levels(traces), BASE["gear_ratio"])


def test_the_drift_of_the_angle_is_found_with_the_ripple(problem):
    first = problem.angles[0].copy()
    before = fit(problem, Hypothesis(MODEL, (RIPPLE,)))
    after = aligned(problem, before)
    assert before.cost > 1.3 * problem.rows
    assert after.cost - problem.rows < 0.3 * (before.cost - problem.rows)
    found = after.hypothesis.model(after.theta).effects[-1].values
    assert found["amplitude_nm"] == pytest.approx(0.7, rel=0.05)
    assert np.ptp(problem.angles[0][:, 1] - first[:, 1]) > 0.05
    assert np.all(problem.angles[0][:, 0] == first[:, 0])


def test_without_a_ripple_nothing_is_moved(problem):
    first = problem.angles[0]
    one = fit(problem, Hypothesis(MODEL), rounds=1)
    assert aligned(problem, one) is one
    assert problem.angles[0] is first
