"""Friction tells which way an axle turned that nobody measured the speed of."""

from pathlib import Path

import numpy as np

from hil.analysis.diagnosis.data.noise import noise_levels
from hil.analysis.diagnosis.data.trace import trace_of
from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.fit.problem import Problem, problem_of
from hil.analysis.diagnosis.search.hidden_speeds import with_hidden_speeds
from hil.core.channels import INPUT, OUTPUTS, TIME
from hil.core.effects import EFFECTS
from hil.core.model import EffectUse
from hil.core.recording import Recording
from hil.plant import Start, simulate
from tests.hil.analysis.diagnosis.one_recording import MODEL, one_problem
from tests.hil.analysis.diagnosis.reference_plant import BASE

FRICTION = EffectUse("coulomb_friction", EFFECTS["coulomb_friction"].completed({"torque_nm": 2.0}))


def _coasting(speed: float) -> Problem:
    """Shaft torque alone, of an axle that coasts from `speed` (rad/s of the motor) against dry friction."""
    rng = np.random.default_rng(1)
    torque = np.where(np.arange(3000) < 1500, 0.0, 5.0)
    clean = simulate(
        MODEL.with_effects(FRICTION), torque, 1e-3, Start(speed, speed / BASE["gear_ratio"], 0.0)
    )
    channels = {TIME: np.arange(3000) * 1e-3, INPUT: torque}
    channels[OUTPUTS[2]] = clean[OUTPUTS[2]] + rng.normal(0.0, 0.5, 3000)
    traces = [trace_of(Recording(channels, Path("coasting.csv")))]
    return problem_of(traces, noise_levels(traces), BASE["gear_ratio"])


def test_the_axle_is_found_to_have_turned_and_which_way() -> None:
    hypothesis = Hypothesis(MODEL, (FRICTION,))
    for speed in (80.0, -80.0):
        problem = _coasting(speed)
        (start,) = with_hidden_speeds(problem, hypothesis, hypothesis.start(), problem.first_starts())
        assert np.sign(start[0]) == np.sign(speed)
        assert start[1] == start[0] / BASE["gear_ratio"]


def test_a_measured_speed_is_not_guessed_at() -> None:
    problem = one_problem(FRICTION, seconds=1.0)
    hypothesis = Hypothesis(MODEL, (FRICTION,))
    starts = problem.first_starts()
    assert with_hidden_speeds(problem, hypothesis, hypothesis.start(), starts)[0] is starts[0]
