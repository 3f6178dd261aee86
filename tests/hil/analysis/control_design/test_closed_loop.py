"""Stability of the sampled loop against python-control and against Nyquist's criterion."""

from __future__ import annotations

import control
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import signal

from hil.analysis.control_design import (
    closed_loop_poles,
    encirclements,
    feedback_functions,
    feedback_response,
    hold_response,
    lead,
    loop_grid,
)
from hil.core.controller import Lead, Notch, Wsc
from hil.core.errors import BadInputError
from hil.core.model import TransferFunction
from tests.hil.analysis import paper_plant

STEP = 0.001
GRID = loop_grid(STEP, 20_000)
MOTOR = TransferFunction(paper_plant.NUMERATORS["motor_speed_rad_s"], paper_plant.DENOMINATOR, 0.008)
PARTS = [None, lead(36, 40), lead(50, 25, "centre"), Notch(frequency_hz=10.6, width=2.0, depth=0.08)]


def blocks(gain: float, part: object) -> tuple[TransferFunction, ...]:
    wsc = Wsc(
        proportional_gain=gain,
        integral_gain=0.15 * gain,
        filter_time_constant_s=0.05,
        lead=part if isinstance(part, Lead) else None,
        notch=part if isinstance(part, Notch) else None,
    )
    return feedback_functions(wsc)


def reference(plant: TransferFunction, parts: tuple[TransferFunction, ...], late: int) -> np.ndarray:
    """The same loop by python-control, for a dead time of whole samples."""
    held = control.sample_system(control.ss(control.tf(plant.numerator, plant.denominator)), STEP, "zoh")
    if late:
        chain = control.ss(np.eye(late, k=-1), np.eye(late, 1), np.eye(late)[-1:], [[0]], STEP)
        held = control.series(chain, held)
    for block in parts:
        top, bottom = signal.bilinear(block.numerator, block.denominator, 1 / STEP)
        held = control.series(control.ss(control.tf(top, bottom, STEP)), held)
    return np.asarray(control.feedback(held, 1).poles())


@given(st.floats(0.3, 30.0), st.sampled_from(PARTS), st.sampled_from([0, 1, 3, 8]))
@settings(max_examples=40, deadline=None)
def test_poles_against_python_control(gain: float, part: object, late: int) -> None:
    plant = TransferFunction(MOTOR.numerator, MOTOR.denominator, late * STEP)
    parts = blocks(gain, part)
    mine, theirs = closed_loop_poles(plant, parts, STEP), reference(plant, parts, late)
    # Poles at z = 0 that delay states bring may differ in number; those that count are the large ones.
    large = [np.sort(np.abs(p[np.abs(p) > 0.5])) for p in (mine, theirs)]
    np.testing.assert_allclose(large[0], large[1], atol=2e-5)


@given(st.floats(0.3, 30.0), st.sampled_from(PARTS), st.floats(0.0, 0.03))
@settings(max_examples=60, deadline=None)
def test_poles_agree_with_nyquist_for_any_dead_time(gain: float, part: object, delay_s: float) -> None:
    plant = TransferFunction(MOTOR.numerator, MOTOR.denominator, delay_s)
    parts = blocks(gain, part)
    poles = np.abs(closed_loop_poles(plant, parts, STEP))
    loop = plant.response(GRID) * hold_response(GRID, STEP) * feedback_response(parts, GRID, STEP)
    # The response leaves out what sampling mirrors from above half the rate; the poles do not.
    decided = {bool(encirclements(loop * change, 2) == 0) for change in (0.8, 1.0, 1.25)}
    if len(decided) > 1 or abs(loop[-1]) > 0.2:
        return  # too near to call by the response
    assert decided == {bool(np.all(poles < 1))}


def test_what_sampling_mirrors_is_seen() -> None:
    """No dead time and much gain: unstable at half the sampling rate, where |L| looks like 0.4."""
    plant = TransferFunction(MOTOR.numerator, MOTOR.denominator, 0.0)
    poles = closed_loop_poles(plant, blocks(16.0, lead(50, 25, "centre")), STEP)
    assert np.sum(np.abs(poles) > 1) == 1
    assert poles[np.argmax(np.abs(poles))].real < -1


@pytest.mark.parametrize("late_s", [0.0, 0.0004, 0.0080, 0.0123])
def test_a_simulated_loop_grows_as_its_poles_say(late_s: float) -> None:
    """Sample by sample: the plant's exact response to the held command, computed ten times finer."""
    plant = TransferFunction((60.0,), (1.0, 8.0, 4000.0), late_s)
    parts = blocks(3.0, None)
    fine = 10
    held = signal.cont2discrete((np.array(plant.numerator), np.array(plant.denominator)), STEP / fine)
    top, bottom = np.ravel(held[0]), np.ravel(held[1])
    pi_top, pi_bottom = signal.bilinear(parts[0].numerator, parts[0].denominator, 1 / STEP)
    count, late = 3000, round(late_s / STEP * fine)
    speed, commands = np.zeros(count * fine), np.zeros(count * fine)
    error_before = command_before = 0.0
    for k in range(count * fine):
        for lag in (1, 2):
            if k >= lag:
                acting = commands[k - lag - late] if k - lag >= late else 0.0
                speed[k] += top[lag] * acting - bottom[lag] * speed[k - lag]
        if k % fine == 0:
            error = (1.0 if k == 0 else 0.0) - speed[k]
            command = pi_top[0] * error + pi_top[1] * error_before - pi_bottom[1] * command_before
            error_before, command_before = error, command
        commands[k] = command_before
    sampled = np.abs(speed[::fine])
    first, last = np.max(sampled[500:1500]), np.max(sampled[2000:3000])
    poles = np.abs(closed_loop_poles(plant, parts, STEP))
    expected = np.max(poles[poles < 1.5])
    if abs(expected - 1) < 3e-5:
        return
    assert (last > first) == (expected > 1)


@pytest.mark.parametrize("slow_rad_s", [1e-6, 1e-4, 1e-2, 0.1])
def test_a_slow_pole_in_place_of_the_integrator_is_no_encirclement(slow_rad_s: float) -> None:
    plant = TransferFunction((1.0,), (4.5, 4.5 * slow_rad_s), 0.008)
    parts = blocks(2.7, None)
    loop = plant.response(GRID) * hold_response(GRID, STEP) * feedback_response(parts, GRID, STEP)
    assert np.all(np.abs(closed_loop_poles(plant, parts, STEP)) < 1)
    assert encirclements(loop, 1) == 0


def test_numbers_beyond_floating_point_are_refused() -> None:
    with pytest.raises(BadInputError, match="too large or too small"):
        closed_loop_poles(TransferFunction((1e308,), (1e-300, 1e308), 0.0), blocks(1.0, None), STEP)
