"""The bootstrap of false names: noise alone scores as much as it says, and no more."""

import numpy as np
import pytest
from scipy.signal import lfilter

from hil.analysis.diagnosis.data.noise import noise_levels
from hil.analysis.diagnosis.data.trace import trace_of
from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.fit.fit import fit
from hil.analysis.diagnosis.fit.problem import Problem, problem_of
from hil.analysis.diagnosis.search.by_chance import most_by_chance
from hil.analysis.diagnosis.search.screen import screen
from hil.core.channels import INPUT, OUTPUTS, TIME
from hil.core.model import Model
from hil.core.recording import Recording
from hil.plant import simulate
from tests.hil.analysis.diagnosis.reference_plant import BASE

MODEL = Model("three_inertia", dict(BASE))


def noisy(path, seed: int, memory: float) -> Problem:
    """A recording of the model itself with noise, the slower the nearer `memory` is to 1."""
    rng = np.random.default_rng(seed)
    time = np.arange(0.0, 12.0, 1e-3)
    torque = 20.0 * np.sin(2 * np.pi * (0.2 * time + 0.6 * time**2))
    clean = simulate(MODEL, torque, 1e-3)
    channels = {TIME: time, INPUT: torque}
    for name, level in zip(OUTPUTS, (0.5, 0.05, 1.0), strict=True):
        slow = lfilter([1.0], [1.0, -memory], rng.normal(0.0, 0.1 * level, len(time)))
        channels[name] = clean[name] + slow + rng.normal(0.0, level, len(time))
    traces = [trace_of(Recording(channels, path / "one.csv"))]
    return problem_of(traces, noise_levels(traces), BASE["gear_ratio"])


@pytest.mark.parametrize(
    "memory", [pytest.param(0.0, marks=pytest.mark.hunt), pytest.param(0.98, marks=pytest.mark.slow)]
)
def test_noise_scores_as_the_bootstrap_says(tmp_path, memory):
    scores, predicted = [], []
    for seed in range(6):
        problem = noisy(tmp_path, seed, memory)
        one = fit(problem, Hypothesis(MODEL))
        scores.append(screen(problem, one)[0].gain)
        predicted.append(most_by_chance(problem, one))
    assert max(scores) < 1.5 * max(predicted)
    assert max(scores) > 0.15 * max(predicted)


def test_slow_noise_scores_more_than_white(tmp_path):
    white, slow = (noisy(tmp_path, 1, memory) for memory in (0.0, 0.99))
    chances = [most_by_chance(p, fit(p, Hypothesis(MODEL))) for p in (white, slow)]
    assert chances[1] > 2.0 * chances[0]
