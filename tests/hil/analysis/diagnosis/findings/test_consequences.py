"""What a new model changes in what the bench is judged by."""

import numpy as np
import pytest
from scipy import signal

from hil.analysis.diagnosis.findings.consequences import consequences, why_no_step
from hil.analysis.diagnosis.findings.result import derived_of
from hil.core.model import EffectUse, Model
from hil.plant import Start, simulate
from tests.hil.analysis.diagnosis.one_recording import MODEL

LOOP = EffectUse("shaft_hysteresis", {"stiffness_nm_rad": 1000.0, "slip_rad": 0.01})


def test_nothing_changes_with_the_same_model() -> None:
    for values in consequences(MODEL, MODEL).values():
        assert values["before"] == values["after"]


def test_less_damping_overshoots_more() -> None:
    loose = MODEL.with_parameters(shaft_damping=0.3 * MODEL.parameters["shaft_damping"])
    told = consequences(MODEL, loose)["overshoot_shaft_torque_percent"]
    assert told["after"] > told["before"] > 0.0


def test_dead_time_alone_changes_next_to_nothing_of_what_rings() -> None:
    """A window that is zero where the step rings would show when the step comes."""
    late = MODEL.with_effects(EffectUse("dead_time", {"extra_delay_s": 0.02}))
    told = consequences(MODEL, late)["band_energy_motor_speed"]
    assert told["after"] == pytest.approx(told["before"], rel=0.05)


def test_the_energy_is_what_scipy_says() -> None:
    torque = np.concatenate([np.zeros(1000), np.full(5000, 20.0)])
    ratio = MODEL.parameters["gear_ratio"]
    out = simulate(MODEL, torque, 1e-3, Start(5.0 * ratio, 5.0, 0.0, motor_torque_nm=0.0))
    ringing = signal.detrend(out["motor_speed_rad_s"][1000:])
    f, density = signal.periodogram(ringing, 1000.0, detrend=False)
    inside = (f >= 8.0) & (f <= 20.0)
    told = consequences(MODEL, MODEL)["band_energy_motor_speed"]["before"]
    assert told == pytest.approx(np.sum(density[inside]) * f[1], rel=0.02)


def test_a_rigid_axle_neither_overshoots_nor_rings() -> None:
    inertias = {k: MODEL.parameters[k] for k in ("motor_inertia", "gear_ratio", "vehicle_inertia")}
    rigid = Model("rigid", {**inertias, "viscous_drag": 0.01, "torque_delay": 0.0})
    assert consequences(rigid, rigid) == {}
    assert "rigid" in why_no_step(rigid)


def test_a_model_that_is_stepped_has_no_reason_against_it() -> None:
    assert why_no_step(MODEL) == ""


def test_no_overshoot_over_a_shaft_torque_that_does_not_last() -> None:
    """A servo without a load: drag holds the motor, and its shaft carries nothing in the end."""
    servo = {"motor_inertia": 4.5e-4, "gear_ratio": 1.0, "shaft_stiffness": 100.0, "shaft_damping": 0.05}
    servo |= {"vehicle_inertia": 1e-4, "viscous_drag": 0.012, "torque_delay": 0.0}
    alone = Model("two_inertia", servo)
    assert [*consequences(alone, alone)] == ["band_energy_motor_speed"]
    assert [*consequences(MODEL, MODEL, [MODEL, MODEL])] == [
        "overshoot_shaft_torque_percent",
        "band_energy_motor_speed",
    ]


def test_a_loop_loses_energy_by_its_stiffness() -> None:
    twice = EffectUse("shaft_hysteresis", {**LOOP.values, "stiffness_nm_rad": 2000.0})
    one, two = (derived_of(use)["loop_area_j"] for use in (LOOP, twice))
    assert two == pytest.approx(2.0 * one)
    # at most: a path that slips at once, over four slip twists and back
    assert one < 1000.0 * 0.01 * 4 * 4 * 0.01
