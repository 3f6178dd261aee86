"""Effects that show the same: which of them it is the base's word decides, or nothing does."""

from __future__ import annotations

import numpy as np
import pytest

from hil.analysis.missing_effects import Outcome, explain_gap, series_of
from hil.core.model import EffectUse, Model
from tests.hil.analysis.missing_effects.chain import NUMBERS, chirp

_GAIN = EffectUse("sensor_gain", {"channel": "shaft_torque_nm", "gain": 1.036})


def _asked(effect: EffectUse, **off: float) -> Outcome:
    """What is said of a chirp with an effect, from a base whose numbers are off by such factors."""
    model = Model("two_inertia", {name: value * off.get(name, 1.0) for name, value in NUMBERS.items()})
    return explain_gap(model, series_of(model, [chirp(0.005, effect)]))


def test_of_gains_that_show_the_same_a_calibrated_base_tells_those_that_leave_its_teeth_alone() -> None:
    found = _asked(_GAIN, shaft_stiffness=0.99, vehicle_inertia=1.015)
    (named,) = found.effects
    assert {named.use.values.get("channel", named.id), *named.alike} <= {
        "shaft_torque_nm",
        "torque_gain",
        "sensor_gain(shaft_torque_nm)",
    }
    assert float(named.use.values["gain"]) == pytest.approx(1.036, abs=3e-3)
    assert found.model.parameters["gear_ratio"] == pytest.approx(NUMBERS["gear_ratio"], rel=2e-3)


def test_a_small_lag_is_not_told_as_a_wrong_dead_time() -> None:
    found = _asked(EffectUse("actuator_lag", {"time_constant_s": 1e-3}), shaft_stiffness=0.99)
    (named,) = found.effects
    assert named.id == "actuator_lag"
    assert (
        abs(float(named.use.values["time_constant_s"]) - 1e-3) < 3.0 * named.standard_error["time_constant_s"]
    )


def test_no_number_is_told_to_be_known_better_than_a_model_is_right() -> None:
    found = _asked(_GAIN, shaft_stiffness=0.99)
    shares = [error / value for _, value, error in found.numbers.values() if value]
    assert np.min(shares) >= 1e-3
