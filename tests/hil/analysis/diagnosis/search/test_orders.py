"""Orders of turning in what a model leaves unexplained."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from hil.analysis.diagnosis.data.noise import noise_levels
from hil.analysis.diagnosis.data.trace import trace_of
from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.fit.fit import fit
from hil.analysis.diagnosis.fit.problem import problem_of
from hil.analysis.diagnosis.search.orders import order_lines
from hil.core.channels import INPUT, OUTPUTS, TIME
from hil.core.model import EffectUse
from hil.core.recording import Recording
from hil.plant import simulate
from tests.hil.analysis.diagnosis.one_recording import MODEL, NOISE, one_problem


def test_the_order_of_a_ripple_is_found() -> None:
    ripple = EffectUse("motor_order_ripple", {"order": 4.0, "amplitude_nm": 1.0, "phase_rad": 0.5})
    rng = np.random.default_rng(4)
    time = np.arange(0.0, 10.0, 1e-3)
    torque = 12.0 + 8.0 * np.sin(2 * np.pi * 0.4 * time)
    channels = {TIME: time, INPUT: torque}
    clean = simulate(MODEL.with_effects(ripple), torque, 1e-3)
    for name, level in zip(OUTPUTS, NOISE, strict=True):
        channels[name] = clean[name] + rng.normal(0.0, level, len(time))
    traces = [trace_of(Recording(channels, Path("turning.csv")))]
    problem = problem_of(traces, noise_levels(traces), MODEL.parameters["gear_ratio"])
    lines = order_lines(problem, fit(problem, Hypothesis(MODEL)), "motor")
    assert lines[0].order == pytest.approx(4.0, abs=0.05)
    assert lines[0].side == "motor"


def test_an_axle_that_hardly_turns_shows_no_order() -> None:
    problem = one_problem()
    still = dataclasses.replace(problem, angles=(0.01 * problem.angles[0],))
    assert order_lines(still, fit(still, Hypothesis(MODEL), rounds=0), "wheel") == []
