"""A model without any loss does not drift where recordings do not say which loss it lacks."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hil.analysis.missing_effects._fit import point_at, with_better_starts
from hil.analysis.missing_effects._hypothesis import Hypothesis
from hil.analysis.missing_effects._problem import Problem
from hil.analysis.missing_effects._share import held_against_drift
from hil.core.model import EffectUse
from tests.hil.analysis.missing_effects.chain import chirp_problem, multisine_problem

_DRAG = EffectUse("load_viscous_drag", {"coefficient_nms_rad": 0.05})
_BIAS_NM = 0.2


def _problem() -> Problem:
    """Two motors with a drag and a multisine, whose torque is read with a bias that makes a model drift."""
    problem = multisine_problem(1.0, _DRAG)
    return replace(
        problem, series=tuple(replace(one, torque=one.torque + _BIAS_NM) for one in problem.series)
    )


def test_a_drag_keeps_a_model_from_drifting_where_nothing_names_one() -> None:
    problem = _problem()
    hypothesis = Hypothesis(problem.model, dict(problem.model.parameters))
    point = with_better_starts(problem, point_at(problem, hypothesis))
    use = held_against_drift(problem, point)
    assert use is not None
    held = point_at(problem, hypothesis.with_term(use), point.starts)
    before, after = (np.sum(np.square(one.errors[0][:, :2])) for one in (point, held))
    assert after < 0.5 * before


def test_a_ripple_is_no_loss() -> None:
    problem = _problem()
    ripple = EffectUse("motor_order_ripple", {"order": 4.0, "amplitude_nm": 1e-3, "phase_rad": 0.0})
    hypothesis = Hypothesis(problem.model, dict(problem.model.parameters)).with_term(ripple)
    assert held_against_drift(problem, with_better_starts(problem, point_at(problem, hypothesis))) is not None


@pytest.mark.parametrize("which", ["loss", "chirp"])
def test_a_loss_that_is_there_or_a_torque_that_excites_all_needs_none(which: str) -> None:
    problem = _problem() if which == "loss" else chirp_problem(1.0, _DRAG)
    hypothesis = Hypothesis(problem.model, dict(problem.model.parameters))
    if which == "loss":
        hypothesis = hypothesis.with_term(_DRAG)
    assert held_against_drift(problem, point_at(problem, hypothesis)) is None
