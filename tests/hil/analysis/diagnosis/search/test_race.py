"""Dry friction of servo drives that somebody begins to look at with numbers of a data sheet.

The drives are integrated here, in steps of 50 microseconds, and share nothing with the plant of the project.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from hil.analysis.diagnosis import Diagnosis, diagnose
from hil.core.channels import INPUT, OUTPUTS, TIME
from hil.core.model import Model
from hil.core.recording import Recording

STEP_S, TAKEN = 5e-5, 20  # every millisecond is recorded
Speed = float
Torque = Callable[[float, Speed], float]


def servo(
    torque: Torque,
    seconds: float,
    *,
    inertia: float,
    drag: float,
    friction: float,
    offset: float = 0.0,
    begins: float = 0.0,
    seed: int = 0,
    rounded: float = 0.0,
    late: int = 0,
    warms: float = 0.0,
) -> Recording:
    """A rotor with drag in N m s/rad, friction and its offset in N m, from a speed in rad/s.

    Its torque is recorded `late` samples late; friction falls by a share of `warms` as it turns.
    """
    speed, held, rows = begins, 0.0, []
    for k in range(round(seconds / STEP_S)):
        if k % TAKEN == 0:
            held = torque(k * STEP_S, speed)
            rows.append((k * STEP_S, held, speed))
        dry = friction * (1.0 - warms * k * STEP_S / seconds)
        push = held - offset - drag * speed
        after = speed + STEP_S / inertia * (push - np.sign(speed) * dry)
        if speed == 0.0:
            after = STEP_S / inertia * np.sign(push) * max(abs(push) - dry, 0.0)
        speed = 0.0 if speed * after < 0.0 else after
    found = np.array(rows)
    found[late:, 1] = found[: len(found) - late, 1]
    measured = found[:, 2] + 0.02 * np.random.default_rng(seed).standard_normal(len(found))
    if rounded:
        measured = np.round(measured / rounded) * rounded
    return Recording(
        {TIME: found[:, 0], INPUT: found[:, 1], OUTPUTS[0]: measured}, Path(f"servo_{seed}.mcap")
    )


def data_sheet(inertia: float, drag: float) -> Model:
    """One mass, no gear, and no dry friction: data sheets have none."""
    numbers = {"motor_inertia": 0.999 * inertia, "vehicle_inertia": 0.001 * inertia, "viscous_drag": drag}
    return Model("rigid", {**numbers, "gear_ratio": 1.0, "torque_delay": 0.0})


def speeds_held(levels: tuple[float, ...], each_s: float) -> Torque:
    """A PI controller, every millisecond, that holds one speed after the other."""
    sums = [0.0]

    def torque(time_s: float, speed: float) -> float:
        miss = levels[min(int(time_s / each_s), len(levels) - 1)] - speed
        sums[0] = float(np.clip(sums[0] + 1e-3 * 0.8 * miss, -2.0, 2.0))
        return float(np.clip(0.02 * miss + sums[0], -3.0, 3.0))

    return torque


def friction_of(found: Diagnosis) -> float:
    """Coulomb friction that was named, N m."""
    (one,) = [e for e in found.effects if e.use.id == "coulomb_friction"]
    return float(one.use.values["torque_nm"])


@pytest.mark.parametrize("drag", [1.8e-4, 6e-4])
def test_two_speeds_and_a_drag_that_is_a_guess_are_friction_and_no_offset_of_a_sensor(drag: float) -> None:
    # at two steady speeds drag and an offset of the speed explain all that friction does: changes tell
    measured = [
        servo(
            speeds_held(levels, 0.9),
            2.7,
            inertia=2.06e-4,
            drag=1.9e-3,
            friction=0.71,
            seed=seed,
            begins=-110.0,
            late=2,
        )
        for seed, levels in enumerate([(-110.0, 220.0, -110.0), (-110.0, 220.0, 110.0)])
    ]
    found = diagnose(data_sheet(2.07e-4, drag), measured[:1], measured[1:])
    assert found.verdict == "named"
    assert "sensor_offset" not in [e.use.id for e in found.effects]
    assert friction_of(found) == pytest.approx(0.71, rel=0.05)


@pytest.mark.slow
def test_steps_of_torque_with_a_rounded_speed_are_friction_and_no_limit_of_torque() -> None:
    steps = [(-0.03, -0.045), (-0.03, -0.04), (0.05, 0.065), (0.05, 0.06)]
    measured = []
    for seed, (before, after) in enumerate(steps):
        begins = (before - 0.009 - np.sign(before) * 0.021) / 1.33e-4
        torque: Torque = lambda t, _, b=before, a=after: b if t < 1.0 else a  # type: ignore[misc] # noqa: E731
        measured.append(
            servo(
                torque,
                8.0,
                inertia=1.57e-4,
                drag=1.33e-4,
                friction=0.021,
                offset=0.009,
                begins=begins,
                seed=seed,
                rounded=0.628,
                warms=0.2,
            )
        )
    found = diagnose(data_sheet(2.26e-4, 7e-5), measured)
    assert friction_of(found) == pytest.approx(0.021, rel=0.1)
