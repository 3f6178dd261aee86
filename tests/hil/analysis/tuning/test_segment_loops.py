"""Speed, mass, friction and controller of each segment, and what they make of the loop."""

from __future__ import annotations

import numpy as np
import pytest

from hil.analysis.tuning import SpeedLoops, driven_segments, gain_factor, sliding, with_mass
from hil.core.controller import controller_from_toml, load_controller
from hil.core.model import load_model
from hil.engine.bench.bench_file import shipped
from hil.plant import linear_system
from test_plans import load_plan

AXLE = load_model(shipped("three_inertia.toml"))


def test_speed_and_friction_are_those_that_were_set_last() -> None:
    found = {one.id: one for one in driven_segments(load_plan("take_off_on_low_friction"))}
    assert found["take_off_ice"].friction == 0.05
    assert found["tip_in_ice"].speed_m_s == pytest.approx(20 / 3.6)
    assert found["tip_in_dry"].friction == 1.0
    assert found["tip_in_dry"].file.stem == "slip_limit"


def test_a_sliding_car_is_rotor_and_wheel_alone() -> None:
    slid = sliding(AXLE)
    assert slid is not None
    system = linear_system(slid)
    response = system.response(np.array([0.05]))[system.outputs.index("motor_speed_rad_s")][0]
    p = AXLE.parameters
    inertia = p["motor_inertia"] + p["wheel_inertia"] / p["gear_ratio"] ** 2
    assert abs(response) == pytest.approx(1 / (2 * np.pi * 0.05 * inertia), rel=1e-3)


def test_mass_is_inertia_at_the_wheels() -> None:
    assert with_mass(AXLE, 1000.0).parameters["vehicle_inertia"] == 1000.0 * AXLE.wheel_radius_m**2
    assert with_mass(AXLE, None) is AXLE


def test_a_schedule_counts_at_its_speed() -> None:
    plan = load_plan("acceptance")
    plain = load_controller(driven_segments(plan)[0].file)
    assert gain_factor(plain, 10.0) == 1.0
    text = driven_segments(plan)[0].file.read_text("utf-8")
    table = "\n[schedule]\nspeed_m_s = [0.0, 10.0]\nwsc_factor = [1.0, 0.5]\n"
    scheduled = controller_from_toml(text + table, "it")
    assert gain_factor(scheduled, 5.0) == pytest.approx(0.75)


def test_a_sliding_car_has_a_stable_loop_with_the_shipped_lead() -> None:
    slid = sliding(AXLE)
    assert slid is not None
    loops = SpeedLoops([AXLE, slid], 0.001)
    lead = load_controller(driven_segments(load_plan("acceptance"))[1].file)
    assert loops.margins(lead, 0).stable
    assert loops.margins(lead, 1).stable
