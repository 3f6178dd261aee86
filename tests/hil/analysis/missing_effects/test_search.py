"""Steps of the search that a data set has shown to be needed."""

from __future__ import annotations

import numpy as np
import pytest

from hil.analysis.missing_effects._candidates import LOOK, Candidates
from hil.analysis.missing_effects._hypothesis import Hypothesis
from hil.analysis.missing_effects._search import _among_losses, _pruned
from hil.core.model import EffectUse, Model
from tests.hil.analysis.missing_effects.chain import RIGID, driven, problem_about
from tests.hil.analysis.missing_effects.turning_mass import base as mass
from tests.hil.analysis.missing_effects.turning_mass import recording
from tests.hil.analysis.missing_effects.two_masses import base, braked


def test_a_loss_that_bends_gives_way_to_a_dry_and_a_viscous_one() -> None:
    """Rolling and air took the place of both, and no name that joined them took off half of what stayed.

    The mass rests below its dry friction, which neither law with a dry part does: either may be likelier.
    """
    model = base()
    done = Candidates(problem_about(model, braked(0.6, 0.7)))
    alone = done.fitted(Hypothesis(model, dict(model.parameters)), None)
    done.go_on_from(alone)
    rolling = EffectUse("running_resistance", {"rolling_nm": 0.6, "aero_nms2_rad2": 0.02})
    first = done.fitted(alone.point.hypothesis.with_term(rolling), alone)
    found = _among_losses(done, first, lambda _: None)
    sizes = {use.id: use.values for use in found.point.hypothesis.terms}
    assert done.score(found) > done.score(first) + 100.0
    assert sizes["load_viscous_drag"]["coefficient_nms_rad"] == pytest.approx(0.7, rel=0.06)
    dry = sizes.get("load_coulomb_friction", {}).get("torque_nm")
    assert (dry or sizes["running_resistance"]["rolling_nm"]) == pytest.approx(0.6, rel=0.06)


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
def test_a_name_that_takes_nothing_off_leaves_though_it_came_last(order: tuple[int, int]) -> None:
    """What was opened beside it may be all that it brought."""
    model = mass(0.54, 2.17)
    done = Candidates(problem_about(model, recording(0.54, 2.17, 1.39)))
    friction = EffectUse("coulomb_friction", {"torque_nm": 1.39})
    air = EffectUse("running_resistance", {"rolling_nm": 0.0, "aero_nms2_rad2": 1e-5})
    both = Hypothesis(model, dict(model.parameters))
    for index in order:
        both = both.with_term((friction, air)[index])
    assert _pruned(done, done.fitted(both, None), lambda _: None).names == ("coulomb_friction",)


def test_a_dead_time_goes_to_the_likeliest_place_within_its_sample() -> None:
    """A rigid axle's shaft torque steps with the sample: no slope leads from 8.97 to the base's 8.1 ms."""
    model = Model("rigid", RIGID)
    time = np.arange(12_000) * 1e-3
    torque = 40.0 * np.sign(np.sin(2.0 * np.pi * 0.3 * time)) + 10.0 * np.sin(2.0 * np.pi * 5.0 * time)
    done = Candidates(problem_about(model, driven(model, torque, 0.01)))
    late = Hypothesis(model, {**model.parameters, "torque_delay": 8.97e-3})
    found = done.fitted(late, None)
    assert found.point.hypothesis.numbers["torque_delay"] == pytest.approx(8.1e-3, abs=0.2e-3)


def test_a_fit_without_a_chance_ends_and_one_that_may_come_near_does_not() -> None:
    """From three times the inertia: rounds and numbers promise the way back, to first order."""
    model = mass(3.0 * 0.54, 2.17)
    done = Candidates(problem_about(model, recording(0.54, 2.17)))
    start = Hypothesis(model, dict(model.parameters))
    whole = done.fitted(start, None)
    done.found.clear()
    near = done.fitted(start, None, at_least=done.score(whole) - 1.0)
    assert done.score(near) > done.score(whole) - 1.0
    done.found.clear()
    hopeless = done.fitted(start, None, at_least=done.score(whole) + 1e4)
    assert done.score(hopeless) == done.score(done.fitted(start, None, LOOK))
