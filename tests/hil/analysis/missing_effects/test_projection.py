"""What a change of outputs promises is near what a fit reaches, where outputs go nearly straight with it."""

from __future__ import annotations

import numpy as np
import pytest

from hil.analysis.missing_effects import explain_gap, series_of
from hil.analysis.missing_effects._candidates import Candidates
from hil.analysis.missing_effects._fit import linearised
from hil.analysis.missing_effects._hypothesis import Hypothesis
from hil.analysis.missing_effects._projection import Projection
from hil.analysis.missing_effects._screen import best_by_name, promises
from hil.core.channels import OUTPUTS
from hil.core.effects import Direction
from hil.core.model import EffectUse, Model
from tests.hil.analysis.missing_effects.chain import RIGID, THREE, chirp, chirp_problem, driven, problem_about

LATE = EffectUse("channel_skew", {"channel": OUTPUTS[1], "delay_s": 5e-4})
GAIN = EffectUse("sensor_gain", {"channel": OUTPUTS[1], "gain": 1.02})
OFFSET = EffectUse("sensor_offset", {"channel": OUTPUTS[2], "offset": 20.0})


@pytest.mark.parametrize("hidden", [LATE, GAIN, OFFSET], ids=lambda use: use.id)
def test_a_promise_is_what_a_fit_reaches(hidden: EffectUse) -> None:
    done = Candidates(chirp_problem(1.0, hidden))
    alone = done.fitted(Hypothesis(done.problem.model, dict(done.problem.model.parameters)), None)
    done.go_on_from(alone)
    problem = done.weighed_as(alone)
    first, *_ = best_by_name(promises(problem, linearised(problem, alone.point)))
    reached = done.fitted(alone.point.hypothesis.with_term(first.use), alone)
    assert first.use.id == hidden.id
    assert first.gain == pytest.approx(reached.log_likelihood - alone.log_likelihood, rel=0.3)
    size = next(name for name in hidden.values if name != "channel")
    assert first.use.values[size] == pytest.approx(hidden.values[size], rel=0.1)


def test_numbers_that_are_fitted_promise_nothing_alone() -> None:
    done = Candidates(chirp_problem(1.0))
    alone = done.fitted(Hypothesis(done.problem.model, dict(done.problem.model.parameters)), None)
    assert done.promised(alone).gain < 1.0
    moved = alone.point.hypothesis.with_number("shaft_stiffness", 6060.0)
    away = done.at(moved, alone)
    assert done.promised(away).gain == pytest.approx(alone.log_likelihood - away.log_likelihood, rel=0.2)


def test_numbers_of_a_far_base_are_promised_no_less_than_they_have() -> None:
    """By one channel nothing tells a scale: along it all numbers walk off once no prior holds them."""
    shown = chirp(0.005, EffectUse("viscous_drag", {"coefficient_nms_rad": 0.003}), axle=THREE)
    torque_alone = shown.without(list(OUTPUTS[:2]))
    far = THREE | {"gear_ratio": 1.013 * THREE["gear_ratio"]}
    done = Candidates(problem_about(Model("three_inertia", far), torque_alone))
    alone = done.fitted(Hypothesis(done.problem.model, dict(done.problem.model.parameters)), None)
    assert Projection(*done.as_it_is(alone)).is_far
    assert done.promised(alone).gain > -0.1


def test_what_runs_away_promises_nothing() -> None:
    problem = chirp_problem(1.0, OFFSET)
    done = Candidates(problem)
    alone = done.fitted(Hypothesis(problem.model, dict(problem.model.parameters)), None)
    project = Projection(problem, linearised(problem, alone.point))
    softens = EffectUse("shaft_cubic_stiffness", {"coefficient_nm_rad3": -1e9})
    of = project.products([alone.point.hypothesis.with_term(softens)])
    assert project.explained(of, slice(0, 1), (Direction({}, 1.0, 1.0),)).gain < 0.0


def test_a_late_shaft_torque_of_a_rigid_axle_is_no_dead_time() -> None:
    """Its slope by the dead time sees a step glide that leaps: it would leave nothing to be late."""
    model = Model("rigid", RIGID | {"torque_delay": 9.75e-3})
    time = np.arange(16_000) * 1e-3
    torque = 30.0 * np.sign(np.sin(2.0 * np.pi * 0.3 * time)) + 10.0 * np.sin(np.pi * time**2)
    skewed = EffectUse("channel_skew", {"channel": OUTPUTS[2], "delay_s": 0.34e-3})
    recording = driven(model.with_effects(skewed), torque, 0.005)
    found = explain_gap(model, series_of(model, [recording]))
    assert [one.id for one in found.effects] == ["channel_skew"]
    assert found.effects[0].use.values["channel"] == OUTPUTS[2]
    assert found.effects[0].use.values["delay_s"] == pytest.approx(0.34e-3, abs=0.02e-3)
