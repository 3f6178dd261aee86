"""What other numbers make up for tells no two models apart."""

import numpy as np
import pytest

from hil.analysis.diagnosis.findings.apart import apart
from hil.core.model import EffectUse, Model
from hil.plant import simulate
from tests.hil.analysis.diagnosis.reference_plant import BASE

MODEL = Model("three_inertia", dict(BASE))
TORQUE = 20.0 * np.sin(2 * np.pi * 3.0 * np.arange(3000) * 1e-3)
NOISE = np.array([0.1, 0.02])


def _played(model: Model) -> np.ndarray:
    shown = simulate(model, TORQUE, 1e-3)
    return np.column_stack([shown["motor_speed_rad_s"], shown["wheel_speed_rad_s"]])


def _rms(one: Model, other: Model) -> float:
    left = apart(one, other, lambda models: np.stack([_played(model) for model in models]), NOISE)
    return float(np.sqrt(np.mean(left**2)))


@pytest.mark.parametrize("name", ["motor_inertia", "shaft_stiffness", "vehicle_inertia"])
def test_another_number_is_made_up_for(name: str) -> None:
    other = MODEL.with_parameters(**{name: 1.005 * BASE[name]})
    plain = float(np.sqrt(np.mean(((_played(MODEL) - _played(other)) / NOISE) ** 2)))
    assert _rms(MODEL, other) < 0.2 * plain


def test_another_size_of_an_effect_is_made_up_for() -> None:
    near, far = (MODEL.with_effects(EffectUse("dead_time", {"extra_delay_s": d})) for d in (4e-3, 4.1e-3))
    assert _rms(near, far) < 0.1


def test_another_law_is_not() -> None:
    friction = MODEL.with_effects(
        EffectUse("coulomb_friction", {"torque_nm": 1.0, "stribeck_torque_nm": 0.0, "offset_nm": 0.0})
    )
    plain = float(np.sqrt(np.mean(((_played(MODEL) - _played(friction)) / NOISE) ** 2)))
    assert _rms(MODEL, friction) > 0.4 * plain
