"""Numbers and names read off momentum and impulse, without a search."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hil.analysis.missing_effects._balance import read_numbers, readings
from hil.analysis.missing_effects._hypothesis import Hypothesis
from hil.analysis.missing_effects._series import series_of
from hil.core.model import Model
from tests.hil.analysis.missing_effects.turning_mass import base, recording


def _inertia(hypothesis: Hypothesis) -> float:
    numbers = hypothesis.numbers
    return numbers["motor_inertia"] + numbers["vehicle_inertia"] / numbers["gear_ratio"] ** 2


@pytest.mark.parametrize("model", [base(0.54, 2.17), base(0.27), base(1.62)])
def test_any_base_gets_the_inertia_and_drag_of_the_data(model: Model) -> None:
    found = read_numbers(model, series_of(model, [recording(0.54, 2.17, 1.39)]))
    assert found is not None
    assert _inertia(found) == pytest.approx(0.54, rel=0.02)
    assert found.numbers["viscous_drag"] == pytest.approx(2.17, rel=0.02)


def test_dry_friction_leaves_least_and_brings_its_size() -> None:
    model = base(1.0)
    series = series_of(model, [recording(0.54, 2.17, 1.39)])
    found = readings(Hypothesis(model, model.parameters), series)
    friction = next(one for one in found if one.hypothesis.names == ("coulomb_friction",))
    assert friction.left < 0.1
    assert friction.hypothesis.terms[0].values["torque_nm"] == pytest.approx(1.39, rel=0.02)


def test_noise_of_single_readings_leaves_numbers_and_friction_alone() -> None:
    """A change over 0.1 s is told by means of 100 readings on either side, where any one is 0.5 rad/s off."""
    model = base(1.0)
    series = series_of(model, [recording(0.54, 2.17, 1.39, noise_rad_s=0.5)])
    found = readings(Hypothesis(model, model.parameters), series)
    friction = next(one.hypothesis for one in found if one.hypothesis.names == ("coulomb_friction",))
    assert _inertia(friction) == pytest.approx(0.54, rel=0.02)
    assert friction.numbers["viscous_drag"] == pytest.approx(2.17, rel=0.05)
    assert friction.terms[0].values["torque_nm"] == pytest.approx(1.39, rel=0.1)


def test_a_dead_time_of_the_base_is_none_of_the_friction() -> None:
    model = replace(base(0.54, 2.17), parameters={**base(0.54, 2.17).parameters, "torque_delay": 0.03})
    late = recording(0.54, 2.17, 1.39)
    torque = late["motor_torque_ref_nm"]
    early = {**late.channels, "motor_torque_ref_nm": np.concatenate([torque[30:], np.zeros(30)])}
    found = readings(Hypothesis(model, model.parameters), series_of(model, [replace(late, channels=early)]))
    friction = next(one.hypothesis for one in found if one.hypothesis.names == ("coulomb_friction",))
    assert friction.numbers["torque_delay"] == 0.03
    assert _inertia(friction) == pytest.approx(0.54, rel=0.01)
    assert friction.terms[0].values["torque_nm"] == pytest.approx(1.39, rel=0.02)


def test_a_mass_that_hardly_moves_beside_its_noise_tells_nothing() -> None:
    model = base(0.54)
    series = series_of(model, [recording(0.54, 2.17, 1.39, torque_nm=0.5, noise_rad_s=0.5)])
    assert not readings(Hypothesis(model, model.parameters), series)


def test_gravity_is_a_ripple_of_order_one_in_phase_with_a_half_turn() -> None:
    model = base(0.54)
    series = series_of(model, [recording(0.54, 1.0, 0.3, 4.0, torque_nm=6.0)])
    best = readings(Hypothesis(model, model.parameters), series)[0].hypothesis
    assert best.names == ("motor_order_ripple",)
    values = best.terms[0].values
    assert values["order"] == pytest.approx(1.0, abs=0.02)
    assert values["amplitude_nm"] == pytest.approx(4.0, rel=0.03)


def test_a_chain_with_shafts_has_no_balance() -> None:
    numbers = {
        "motor_inertia": 0.02,
        "gear_ratio": 8.0,
        "shaft_stiffness": 6000.0,
        "shaft_damping": 20.0,
        "vehicle_inertia": 3.0,
        "torque_delay": 0.0,
    }
    chain = Model("two_inertia", numbers)
    series = series_of(chain, [recording(0.54, 2.17, 1.39)])
    assert not readings(Hypothesis(chain, numbers), series)
