"""Angles that speeds turn through, against what NumPy integrates; ripples follow them in a replay."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hil.core.channels import INPUT, TIME
from hil.core.effects import EFFECTS
from hil.core.model import EffectUse, Model
from hil.core.recording import Recording
from hil.plant import replay, simulate, turned

STEP_S = 1e-3


def test_angles_are_integrals_from_the_first_one() -> None:
    time = np.arange(2000) * STEP_S
    speeds = np.column_stack([50.0 + 10.0 * np.sin(time), 5.0 + np.sin(time)])
    shown = turned(speeds, STEP_S, 10.0, 0.3)
    for column, factor, speed in ((0, 1.0, speeds[:, 1]), (1, 10.0, speeds[:, 0])):
        assert shown[-1, column] - 0.3 * factor == pytest.approx(np.trapezoid(speed, dx=STEP_S))


@pytest.mark.parametrize("missing", [0, 1])
def test_a_speed_that_was_not_recorded_follows_from_the_other(missing: int) -> None:
    speeds = np.tile([50.0, 5.0], (100, 1))
    speeds[:, missing] = np.nan
    assert turned(speeds, STEP_S, 10.0)[-1] == pytest.approx([5.0 * 0.099, 50.0 * 0.099])


def test_a_ripple_keeps_its_phase_where_the_model_would_turn_away() -> None:
    """The model has a tenth too little drag: its own angle is turns ahead at the end, its ripple is not."""
    numbers = {
        "motor_inertia": 0.5,
        "gear_ratio": 1.0,
        "vehicle_inertia": 0.5,
        "viscous_drag": 0.5,
        "torque_delay": 0.0,
    }
    values = EFFECTS["motor_order_ripple"].completed({"order": 4.0, "amplitude_nm": 5.0, "phase_rad": 0.4})
    truth = Model("rigid", numbers, (EffectUse("motor_order_ripple", values),))
    torque = np.full(20_000, 10.0)
    shown = simulate(truth, torque, STEP_S)
    speed = shown["motor_speed_rad_s"]
    recording = Recording(
        {TIME: np.arange(0.0, len(torque)) * STEP_S, INPUT: torque, "motor_speed_rad_s": speed},
        Path("ripple.csv"),
    )
    wrong = truth.with_parameters(viscous_drag=0.45)
    ripple = replay(wrong, recording)["motor_speed_rad_s"]
    ends = slice(-2000, None)
    swing, own = (one[ends] - np.convolve(one, np.ones(79) / 79, "same")[ends] for one in (speed, ripple))
    assert np.corrcoef(swing[:-100], own[:-100])[0, 1] > 0.99
