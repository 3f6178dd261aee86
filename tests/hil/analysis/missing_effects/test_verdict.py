"""Names that the data cannot tell apart, whatever stands beside them."""

from __future__ import annotations

import numpy as np

from hil.analysis.missing_effects._candidates import Candidates
from hil.analysis.missing_effects._fit import linearised, point_at
from hil.analysis.missing_effects._hypothesis import Hypothesis
from hil.analysis.missing_effects._share import Judged, _remains
from hil.analysis.missing_effects._verdict import _alike, _from_far, _held
from hil.core.model import EffectUse, Model
from tests.hil.analysis.missing_effects.chain import RIGID, driven, problem_about
from tests.hil.analysis.missing_effects.two_masses import base, braked

_ROLLING = EffectUse("running_resistance", {"rolling_nm": 0.4, "aero_nms2_rad2": 0.007})
_VISCOUS = EffectUse("load_viscous_drag", {"coefficient_nms_rad": 0.1})
_DRY = EffectUse("coulomb_friction", {"torque_nm": 0.4})


def test_what_a_law_gets_wrong_elsewhere_takes_nothing_from_an_effect_of_one_channel() -> None:
    """An offset of the wheel's speed, beside a law whose error may leave three noises in the other speed."""
    model = base()
    problem = problem_about(model, braked(0.0, 0.7))
    done = Candidates(problem)
    numbers = Hypothesis(model, dict(model.parameters))
    offset = EffectUse("sensor_offset", {"channel": "wheel_speed_rad_s", "offset": 0.1})
    before, after = (
        done.judged(point_at(problem, one))
        for one in (numbers, numbers.with_term(_VISCOUS).with_term(offset))
    )
    assert done.score(after) > done.score(before)
    had, has = (problem.noise**2 * np.array(times) for times in ([1.0, 1000.0, 1.0], [1.0, 1.0, 1.0]))
    of = Judged(model, done, lambda one: had if one is before else has, (), ())
    wrong = problem.noise**2 * np.array([3.0, 3.0, 3.0])
    assert _remains(of, before, after, wrong) < 0.01
    wrong[1] = 500.0 * problem.noise[1] ** 2
    assert 0.4 < _remains(of, before, after, wrong) < 0.6


def test_a_class_holds_what_the_least_of_both_ways_gives_all_of_it() -> None:
    """One way prefers one name, the other the other one: both say one of the two."""
    model = base()
    done = Candidates(problem_about(model, braked(0.0, 0.7)))
    sets = [Hypothesis(model, dict(model.parameters)).with_term(use) for use in (_ROLLING, _VISCOUS, _DRY)]
    candidates = [done.judged(point_at(done.problem, one)) for one in sets]
    weights = np.array([[0.9, 0.08, 0.02], [0.2, 0.75, 0.05]])
    assert np.isclose(_held({"running_resistance"}, candidates, weights), 0.2)
    assert np.isclose(_held({"running_resistance", "load_viscous_drag"}, candidates, weights), 0.95)


def test_names_are_alike_where_one_is_in_the_place_of_the_other_at_odds_below_twenty() -> None:
    """The likeliest set has two names; what stands for one of them stands alone elsewhere."""
    model = base()
    done = Candidates(problem_about(model, braked(0.6, 0.7)))
    sets = ((_ROLLING, _DRY), (_ROLLING,), (_VISCOUS,), (_DRY,))
    numbers = Hypothesis(model, dict(model.parameters))
    found = []
    for uses in sets:
        hypothesis = numbers
        for use in uses:
            hypothesis = hypothesis.with_term(use)
        found.append(done.judged(point_at(done.problem, hypothesis)))
    weights = np.array([[0.1, 0.72, 0.15, 0.03]])
    assert _alike(done, found[0], found, weights) == {
        "running_resistance": ("load_viscous_drag",),
        "coulomb_friction": ("load_viscous_drag",),
    }
    certain = np.array([[0.96, 0.0, 0.004, 0.036]])
    assert _alike(done, found[0], found, certain) == {}


def test_beside_a_far_base_a_gain_is_as_doubtful_as_what_it_hangs_on() -> None:
    """Of a rigid axle the motor's inertia, teeth, load and a speed's gain leave one direction free.

    The base's word on the inertia, which is 40 % off, would settle it, and the gain with it.
    """
    truth = Model("rigid", RIGID)
    model = truth.with_parameters(
        motor_inertia=0.6 * RIGID["motor_inertia"], vehicle_inertia=0.7 * RIGID["vehicle_inertia"]
    )
    gain = EffectUse("sensor_gain", {"channel": "wheel_speed_rad_s", "gain": 1.3})
    time = np.arange(12_000) * 1e-3
    torque = 40.0 * np.sign(np.sin(2.0 * np.pi * 0.3 * time)) + 10.0 * np.sin(2.0 * np.pi * 5.0 * time)
    done = Candidates(problem_about(model, driven(truth.with_effects(gain), torque, 0.01)))
    best = done.fitted(Hypothesis(model, dict(model.parameters)).with_term(gain), None)
    sure = linearised(done.weighed_as(best), best.point).standard_error(0, "gain")
    found, at = _from_far(done, best)
    doubt = at.standard_error(0, "gain")
    assert doubt > 5.0 * sure
    assert abs(float(found.point.hypothesis.terms[0].values["gain"]) - 1.3) < 3.0 * doubt
