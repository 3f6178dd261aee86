"""Numbers and names read off momentum and impulse, without a search."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hil.analysis.missing_effects._balance import read_numbers, readings
from hil.analysis.missing_effects._hypothesis import Hypothesis
from hil.analysis.missing_effects._series import series_of
from hil.core.channels import OUTPUTS
from hil.core.model import EffectUse, Model
from hil.core.recording import Recording
from hil.plant import simulate
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


def test_gravity_is_a_ripple_of_order_one_in_phase_with_a_half_turn() -> None:
    model = base(0.54)
    series = series_of(model, [recording(0.54, 1.0, 0.3, 4.0, torque_nm=6.0)])
    best = readings(Hypothesis(model, model.parameters), series)[0].hypothesis
    assert best.names == ("motor_order_ripple",)
    values = best.terms[0].values
    assert values["order"] == pytest.approx(1.0, abs=0.02)
    assert values["amplitude_nm"] == pytest.approx(4.0, rel=0.03)


def _two_masses(speeds: bool) -> tuple[Model, Recording]:
    """Friction of 5 N m on the load of a two-inertia chain, wheel side, and its exports."""
    numbers = {
        "motor_inertia": 0.02,
        "gear_ratio": 8.0,
        "shaft_stiffness": 6000.0,
        "shaft_damping": 20.0,
        "vehicle_inertia": 3.0,
        "torque_delay": 0.0,
    }
    hidden = Model("two_inertia", numbers, effects=(EffectUse("load_coulomb_friction", {"torque_nm": 5.0}),))
    time = np.arange(20_000) * 1e-3
    torque = 4.0 * np.sign(np.sin(2.0 * np.pi * 0.3 * time)) + np.sin(2.0 * np.pi * 3.0 * time)
    channels = simulate(hidden, torque, 1e-3)
    kept = ("motor_speed_rad_s", "wheel_speed_rad_s") if speeds else OUTPUTS
    shown = {"time_s": time, "motor_torque_ref_nm": torque} | {name: channels[name] for name in kept}
    far = {name: 2.0 * value if name.endswith("inertia") else value for name, value in numbers.items()}
    return Model("two_inertia", far), Recording(shown, Path("two masses.csv"))


@pytest.mark.parametrize("speeds", [True, False])
def test_friction_on_the_load_of_a_chain_is_read_from_a_far_base(speeds: bool) -> None:
    model, measured = _two_masses(speeds)
    best = readings(Hypothesis(model, model.parameters), series_of(model, [measured]))[0].hypothesis
    assert best.names[0] in ("load_coulomb_friction", "running_resistance")
    assert float(next(iter(best.terms[0].values.values()))) == pytest.approx(5.0, rel=0.1)
