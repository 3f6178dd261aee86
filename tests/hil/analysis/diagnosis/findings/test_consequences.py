"""Two models in one test: how far apart, and what a new one changes in what is judged."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import signal

from hil.analysis.diagnosis.findings.consequences import apart, consequences, played, why_no_step
from hil.analysis.diagnosis.findings.result import derived_of
from hil.core.channels import OUTPUTS
from hil.core.model import EffectUse, Model
from hil.plant import Start, gear_ratio_of, simulate
from tests.hil.analysis.diagnosis.one_recording import MODEL as ONE_RECORDING
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


RICHER = (
    MODEL,
    MODEL.with_parameters(shaft_stiffness=1.2 * MODEL.parameters["shaft_stiffness"]),
    MODEL.with_effects(EffectUse("sensor_gain", {"channel": OUTPUTS[1], "gain": 1.05})),
    MODEL.with_effects(EffectUse("dead_time", {"extra_delay_s": 0.004})),
)


@pytest.mark.parametrize("one", range(len(RICHER)))
def test_each_model_is_played_as_if_alone(one: int) -> None:
    torque = np.concatenate([np.zeros(100), np.full(900, 20.0)])
    start = Start(5.0 * (gear_ratio_of(MODEL) or 1.0), 5.0, 0.0, motor_torque_nm=0.0)
    alone = simulate(RICHER[one], torque, 0.001, start)
    together = played(RICHER, torque, 0.001, 5.0)[one]
    for column, channel in enumerate(OUTPUTS):
        size = float(np.max(np.abs(alone[channel])))
        np.testing.assert_allclose(together[:, column], alone[channel], atol=1e-3 * size)


LOOP = EffectUse("shaft_hysteresis", {"stiffness_nm_rad": 1000.0, "slip_rad": 0.01})


def test_nothing_changes_with_the_same_model() -> None:
    for values in consequences(ONE_RECORDING, ONE_RECORDING).values():
        assert values["before"] == values["after"]


def test_less_damping_overshoots_more() -> None:
    loose = ONE_RECORDING.with_parameters(shaft_damping=0.3 * ONE_RECORDING.parameters["shaft_damping"])
    told = consequences(ONE_RECORDING, loose)["overshoot_shaft_torque_percent"]
    assert told["after"] > told["before"] > 0.0


def test_dead_time_alone_changes_next_to_nothing_of_what_rings() -> None:
    """A window that is zero where the step rings would show when the step comes."""
    late = ONE_RECORDING.with_effects(EffectUse("dead_time", {"extra_delay_s": 0.02}))
    told = consequences(ONE_RECORDING, late)["band_energy_motor_speed"]
    assert told["after"] == pytest.approx(told["before"], rel=0.05)


def test_the_energy_is_what_scipy_says() -> None:
    torque = np.concatenate([np.zeros(1000), np.full(5000, 20.0)])
    ratio = ONE_RECORDING.parameters["gear_ratio"]
    out = simulate(ONE_RECORDING, torque, 1e-3, Start(5.0 * ratio, 5.0, 0.0, motor_torque_nm=0.0))
    ringing = signal.detrend(out["motor_speed_rad_s"][1000:])
    f, density = signal.periodogram(ringing, 1000.0, detrend=False)
    inside = (f >= 8.0) & (f <= 20.0)
    told = consequences(ONE_RECORDING, ONE_RECORDING)["band_energy_motor_speed"]["before"]
    assert told == pytest.approx(np.sum(density[inside]) * f[1], rel=0.02)


def test_a_rigid_axle_neither_overshoots_nor_rings() -> None:
    inertias = {k: ONE_RECORDING.parameters[k] for k in ("motor_inertia", "gear_ratio", "vehicle_inertia")}
    rigid = Model("rigid", {**inertias, "viscous_drag": 0.01, "torque_delay": 0.0})
    assert consequences(rigid, rigid) == {}
    assert "rigid" in why_no_step(rigid)


def test_a_model_that_is_stepped_has_no_reason_against_it() -> None:
    assert why_no_step(ONE_RECORDING) == ""


def test_no_overshoot_over_a_shaft_torque_that_does_not_last() -> None:
    """A servo without a load: drag holds the motor, and its shaft carries nothing in the end."""
    servo = {"motor_inertia": 4.5e-4, "gear_ratio": 1.0, "shaft_stiffness": 100.0, "shaft_damping": 0.05}
    servo |= {"vehicle_inertia": 1e-4, "viscous_drag": 0.012, "torque_delay": 0.0}
    alone = Model("two_inertia", servo)
    assert [*consequences(alone, alone)] == ["band_energy_motor_speed"]
    assert [*consequences(ONE_RECORDING, ONE_RECORDING, [ONE_RECORDING, ONE_RECORDING])] == [
        "overshoot_shaft_torque_percent",
        "band_energy_motor_speed",
    ]


def test_a_loop_loses_energy_by_its_stiffness() -> None:
    twice = EffectUse("shaft_hysteresis", {**LOOP.values, "stiffness_nm_rad": 2000.0})
    one, two = (derived_of(use)["loop_area_j"] for use in (LOOP, twice))
    assert two == pytest.approx(2.0 * one)
    # at most: a path that slips at once, over four slip twists and back
    assert one < 1000.0 * 0.01 * 4 * 4 * 0.01
