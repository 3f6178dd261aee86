"""What a new model changes in what the bench is judged by."""

import pytest

from hil.analysis.diagnosis.tell._consequences import consequences
from hil.analysis.diagnosis.tell._result import derived_of
from hil.core.model import EffectUse
from tests.hil.analysis.diagnosis.one_recording import MODEL

LOOP = EffectUse("shaft_hysteresis", {"stiffness_nm_rad": 1000.0, "slip_rad": 0.01})


def test_nothing_changes_with_the_same_model() -> None:
    for values in consequences(MODEL, MODEL).values():
        assert values["before"] == values["after"]


def test_less_damping_overshoots_more() -> None:
    loose = MODEL.with_parameters(shaft_damping=0.3 * MODEL.parameters["shaft_damping"])
    told = consequences(MODEL, loose)["overshoot_shaft_torque_percent"]
    assert told["after"] > told["before"] > 0.0


def test_a_loop_loses_energy_by_its_stiffness() -> None:
    twice = EffectUse("shaft_hysteresis", {**LOOP.values, "stiffness_nm_rad": 2000.0})
    one, two = (derived_of(use)["loop_area_j"] for use in (LOOP, twice))
    assert two == pytest.approx(2.0 * one)
    # at most: a path that slips at once, over four slip twists and back
    assert one < 1000.0 * 0.01 * 4 * 4 * 0.01
