"""What stays as a torque over speed or angle: the curve of what has no name."""

from __future__ import annotations

import numpy as np
import pytest

from hil.analysis.missing_effects._curve import curves_of
from hil.analysis.missing_effects._hypothesis import Hypothesis
from hil.analysis.missing_effects._series import series_of
from hil.core.model import EffectUse
from tests.hil.analysis.missing_effects.turning_mass import base, recording


def test_gravity_that_no_effect_stands_for_shows_as_a_sine_of_the_angle() -> None:
    model = base(0.54, 1.0)
    series = series_of(model, [recording(0.54, 1.0, 0.0, 4.0, torque_nm=6.0)])
    curve = curves_of(Hypothesis(model, model.parameters), series)[0]
    assert curve.over.startswith("angle")
    assert curve.share > 0.9
    assert curve.torque_nm == pytest.approx(4.0 * np.sin(curve.at), abs=0.6)


def test_dry_friction_shows_over_speed_and_is_gone_with_its_effect() -> None:
    model = base(0.54, 2.17)
    series = series_of(model, [recording(0.54, 2.17, 1.39)])
    alone = Hypothesis(model, model.parameters)
    curve = curves_of(alone, series)[0]
    assert curve.over.startswith("speed")
    fast = np.abs(curve.at) > 1.0
    assert curve.torque_nm[fast] == pytest.approx(1.39 * np.sign(curve.at[fast]), abs=0.15)
    named = alone.with_term(EffectUse("coulomb_friction", {"torque_nm": 1.39}))
    left = curves_of(named, series)[0]
    assert np.max(np.abs(left.torque_nm[np.abs(left.at) > 1.0])) < 0.15
