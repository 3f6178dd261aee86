"""Calibration dates of the bench file against today."""

import datetime

from hil.engine.commissioning.doctor.examination import findings_of_dates
from tests.benches_for_tests import sim_bench

TODAY = datetime.date(2026, 11, 22)


def found(**changes):
    return [(finding.severity, finding.what) for finding in findings_of_dates(sim_bench(**changes), TODAY)]


def test_what_has_run_out_and_what_soon_will():
    dates = {
        "shaft_torque_left": datetime.date(2026, 11, 21),
        "shaft_torque_right": datetime.date(2026, 12, 1),
        "motor_speed": TODAY,
        "wheel_speed": datetime.date(2027, 12, 1),
    }
    assert found(calibration=dates) == [
        ("fault", "the calibration of 'shaft_torque_left' expired on 2026-11-21"),
        ("hint", "the calibration of 'shaft_torque_right' expires in 9 days, on 2026-12-01"),
        ("hint", "the calibration of 'motor_speed' expires in 0 days, on 2026-11-22"),
    ]


def test_hardware_without_dates_is_told_and_a_simulated_bench_needs_none():
    assert found() == []
    assert found(simulation=None) == [("hint", "no calibration dates are stated")]
