from __future__ import annotations

import math

import pytest

from hil.core.controller import load_controller
from test_plans import estimate_duration_s, load_plan
from test_plans.loading import LIBRARY
from tests.test_plans.note_taker import NoteTaker

METRICS = (
    "peak_shaft_torque",
    "overshoot_shaft_torque",
    "settling_shaft_torque",
    "band_energy_motor_speed",
)
SEGMENTS = ("gain_0kmh", "phase_0kmh", "gain_20kmh", "phase_20kmh")


def test_acceptance_has_the_segments_and_criteria_of_the_contract() -> None:
    plan = load_plan("acceptance")
    assert tuple(segment.id for segment in plan.segments) == SEGMENTS
    ids = [criterion.id for criterion in plan.criteria]
    assert ids[:16] == [f"{segment}.{metric}" for segment in SEGMENTS for metric in METRICS]
    assert ids[16:] == [
        f"phase_{speed}kmh.{metric}.below.gain_{speed}kmh"
        for speed in (0, 20)
        for metric in ("peak_shaft_torque", "band_energy_motor_speed")
    ]


def test_acceptance_takes_about_96_seconds() -> None:
    assert estimate_duration_s(load_plan("acceptance")) == pytest.approx(96, abs=3)


def test_acceptance_on_a_conductor() -> None:
    conductor = NoteTaker()
    plan = load_plan("acceptance")
    for step in (*plan.steps, *plan.finally_):
        step.execute(conductor)
    third = conductor.calls[8:12]
    assert third[0][0] == "set_controller"
    assert third[1] == ("hold_speed", pytest.approx(20 / 3.6), 2.0)
    assert third[2:] == [("release_vehicle",), ("play", "driving_torque", "gain_20kmh")]
    assert conductor.calls[-1] == ("ramp_down", 2.0)
    for _, samples, segment in conductor.played:
        assert len(samples) == 21_000
        assert segment is not None
        assert (
            (samples[999], samples[1000]) == (segment.reference_before, segment.reference_after) == (0, 326)
        )


def test_identification_covers_its_band_and_the_biased_chirp_never_reverses() -> None:
    conductor = NoteTaker()
    for step in load_plan("identification").steps:
        step.execute(conductor)
    torque = {segment.id: samples for _, samples, segment in conductor.played if segment}
    assert torque["chirp_high"].max() == pytest.approx(20, rel=1e-3)
    assert torque["chirp_low"].max() == pytest.approx(10, rel=1e-3)
    assert torque["chirp_biased"].min() >= 0
    assert all(quantity == "motor_torque" for quantity, _, _ in conductor.played)


def test_controllers_are_the_papers() -> None:
    phase = load_controller(LIBRARY / "controllers" / "phase_stabilization.toml")
    gain = load_controller(LIBRARY / "controllers" / "gain_stabilization.toml")
    assert (phase.stabilization, gain.stabilization) == ("phase", "gain")
    assert phase.wsc.lead is not None
    sine = math.sin(math.radians(36))
    alpha = (1 - sine) / (1 + sine)
    assert phase.wsc.lead.alpha == pytest.approx(alpha, rel=1e-4)
    assert phase.wsc.lead.time_constant_s == pytest.approx(1 / (2 * math.pi * alpha**0.5 * 40), rel=1e-4)
    assert phase.dfo.time_constant_s == pytest.approx(1 / 125.6)
    same = {"name", "wsc"}
    assert phase.model_dump(exclude=same) == gain.model_dump(exclude=same)
    # DC gain of T_s/T_m* is the gear ratio, about; the common factor s cancels.
    assert phase.plant.shaft_torque[-2] / phase.plant.denominator[-2] == pytest.approx(8.12, abs=0.01)
