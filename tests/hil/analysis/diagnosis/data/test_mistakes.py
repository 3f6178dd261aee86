"""Units, signs and columns that were mistaken, where the axle turns too little for ratios to be compared."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.signal import chirp

from hil.analysis.diagnosis.data._sanity import examine
from hil.core.channels import INPUT, OUTPUTS, TIME
from hil.core.errors import BadInputError
from hil.core.model import EffectUse, Model
from hil.core.recording import Recording
from hil.plant import simulate
from tests.hil.analysis.diagnosis.reference_plant import BASE

MOTOR, WHEEL, SHAFT = OUTPUTS
MODEL = Model("three_inertia", dict(BASE))
RIGID = Model(
    "rigid",
    {
        "motor_inertia": 0.02,
        "gear_ratio": 1.0,
        "vehicle_inertia": 0.05,
        "viscous_drag": 0.001,
        "torque_delay": 0.001,
    },
)
AT = np.arange(0.0, 8.0, 1e-3)
QUICK = 5.0 * chirp(AT, 0.7, AT[-1], 30.0, method="logarithmic")
RPM = 60.0 / (2.0 * np.pi)


def recorded(model: Model = MODEL, torque: np.ndarray = QUICK, **factors: float) -> dict[str, np.ndarray]:
    clean = simulate(model, torque, 1e-3)
    rng = np.random.default_rng(0)
    channels = {TIME: AT, INPUT: torque}
    for name, noise in zip(OUTPUTS, (0.02, 0.0014, 0.7), strict=True):
        channels[name] = clean[name] + rng.normal(0.0, noise, len(AT))
    return {name: values * factors.get(name, 1.0) for name, values in channels.items()}


def refused(channels: dict[str, np.ndarray], model: Model = MODEL) -> str:
    with pytest.raises(BadInputError) as error:
        examine(model, [Recording(channels, Path("mistaken.csv"))])
    return error.value.what


@pytest.mark.parametrize(
    ("factors", "said"),
    [
        ({MOTOR: RPM}, f"{MOTOR} looks like rpm"),
        ({WHEEL: RPM}, f"{WHEEL} looks like rpm"),
        ({MOTOR: RPM, WHEEL: RPM}, f"{MOTOR} and {WHEEL} look like rpm"),
        ({INPUT: 1e-3, SHAFT: 1e-3}, f"{INPUT} and {SHAFT} look like kN m"),
        ({MOTOR: -1.0}, f"{MOTOR} looks inverted"),
        ({WHEEL: -1.0}, f"{WHEEL} looks inverted"),
        ({MOTOR: -1.0, WHEEL: -1.0}, f"{MOTOR} and {WHEEL} look inverted"),
    ],
)
def test_a_unit_or_a_sign_is_seen_though_the_axle_hardly_turns(factors, said):
    assert refused(recorded(**factors)).startswith(said)


def test_swapped_columns_are_seen_though_the_axle_hardly_turns():
    channels = recorded()
    channels[MOTOR], channels[WHEEL] = channels[WHEEL], channels[MOTOR]
    assert refused(channels).startswith(f"{MOTOR} and {WHEEL} look swapped")


@pytest.mark.parametrize("factor", [RPM, -1.0])
def test_one_speed_alone_tells_its_unit_and_sign(factor):
    channels = recorded(**{MOTOR: factor})
    assert MOTOR in refused({name: channels[name] for name in (TIME, INPUT, MOTOR)})


def test_a_rigid_drive_without_a_gear_is_no_mistake():
    channels = recorded(RIGID)
    examine(RIGID, [Recording({name: channels[name] for name in (TIME, INPUT, MOTOR)}, Path("r.csv"))])
    examine(RIGID, [Recording(channels, Path("r.csv"))])


@pytest.mark.parametrize(
    "effect",
    [
        EffectUse("backlash", {"half_gap_rad": 0.05}),
        EffectUse("coulomb_friction", {"torque_nm": 4.0}),
        EffectUse("actuator_lag", {"time_constant_s": 0.05}),
        EffectUse("torque_saturation", {"limit_nm": 2.0}),
        EffectUse("sensor_gain", {"channel": SHAFT, "gain": 0.5}),
        EffectUse("channel_skew", {"channel": WHEEL, "delay_s": 0.02}),
        EffectUse("wheel_order_disturbance", {"order": 3.0, "amplitude_nm": 100.0, "phase_rad": 0.0}),
    ],
    ids=lambda use: use.id,
)
def test_a_missing_effect_is_no_mistake(effect):
    examine(MODEL, [Recording(recorded(MODEL.with_effects(effect)), Path("effect.csv"))])


def test_a_resonance_that_lies_elsewhere_turns_no_sign():
    """Between the two resonances what a narrow band shows is the model's opposite."""
    stiffer = MODEL.with_parameters(shaft_stiffness=1.7 * BASE["shaft_stiffness"])
    narrow = 5.0 * chirp(AT, 9.0, AT[-1], 12.0)
    examine(MODEL, [Recording(recorded(stiffer, narrow), Path("narrow.csv"))])
