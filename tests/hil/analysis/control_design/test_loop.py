from __future__ import annotations

import control
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import signal

from hil.analysis.control_design import (
    encirclements,
    feedback_functions,
    feedback_response,
    hold_response,
    lead,
    loop_grid,
    margins,
    sampled_response,
)
from hil.core.controller import Lead, Notch, Wsc
from hil.core.model import Model, TransferFunction
from tests.hil.analysis import paper_plant

GRID = loop_grid(count=20_000)
NOTCH = Notch(frequency_hz=10.6, width=2.0, depth=0.08)


def wsc(part: Lead | Notch | None = None, gain: float = 2.6775) -> Wsc:
    """The paper's wheel speed control with a lead or a notch."""
    return Wsc(
        proportional_gain=gain,
        integral_gain=0.15 * gain,
        filter_time_constant_s=0.05,
        lead=part if isinstance(part, Lead) else None,
        notch=part if isinstance(part, Notch) else None,
    )


def open_loop(model: Model, parts: Wsc, step: float | None = None) -> np.ndarray:
    plant = model.transfer_functions["motor_speed_rad_s"].response(GRID)
    hold = 1.0 if step is None else hold_response(GRID, step)
    return np.asarray(plant * hold * feedback_response(feedback_functions(parts), GRID, step))


def at(loop: np.ndarray, frequency_hz: float) -> complex:
    return complex(np.interp(frequency_hz, GRID, loop))


def test_a_sampled_plant_is_the_z_transform_of_the_held_one() -> None:
    """1/(s + a) behind a zero-order hold: (1 - e^-aT)/a/(z - e^-aT); a hold alone is far off at high f."""
    pole, step = 30.0, 0.001
    frequency = np.array([1.0, 50.0, 200.0, 450.0, 495.0])
    z, decay = np.exp(2j * np.pi * frequency * step), np.exp(-pole * step)
    exact = (1 - decay) / pole / (z - decay)
    plant = TransferFunction((1.0,), (1.0, pole))
    np.testing.assert_allclose(sampled_response(plant, frequency, step), exact, rtol=1.5e-3)
    held = plant.response(frequency) * hold_response(frequency, step)
    assert abs(held[-1] / exact[-1] - 1) > 0.2


def test_pi_at_the_resonance(paper_model: Model) -> None:
    """Independent recomputation of the paper: +14.6 dB and -43.8 degrees at 10.6 Hz."""
    here = at(open_loop(paper_model, wsc()), 10.6)
    assert 20 * np.log10(abs(here)) == pytest.approx(14.55, abs=0.1)
    assert np.degrees(np.angle(here)) == pytest.approx(-43.8, abs=0.1)


def test_lead_normalised_at_high_frequency(paper_model: Model) -> None:
    """Independent recomputation: |S| 1.34 at 41.5 Hz, -8.0 dB at 10.6 Hz."""
    loop = open_loop(paper_model, wsc(lead(36, 40)))
    found = margins(GRID, loop, 2)
    assert found.sensitivity_peak == pytest.approx(1.344, abs=0.003)
    assert found.sensitivity_peak_hz == pytest.approx(41.5, abs=0.1)
    assert -20 * np.log10(abs(1 + at(loop, 10.6))) == pytest.approx(-7.95, abs=0.1)
    assert found.stable


def test_notch(paper_model: Model) -> None:
    """Independent recomputation: |S| 1.48 at 44.1 Hz. It had -2.0 dB at 10.6 Hz, here it is -2.5 dB."""
    loop = open_loop(paper_model, wsc(NOTCH))
    found = margins(GRID, loop, 2)
    assert found.sensitivity_peak == pytest.approx(1.483, abs=0.003)
    assert found.sensitivity_peak_hz == pytest.approx(44.1, abs=0.1)
    assert -20 * np.log10(abs(1 + at(loop, 10.6))) == pytest.approx(-2.54, abs=0.05)


def test_lead_with_unity_gain_at_dc_is_nearly_unstable(paper_model: Model) -> None:
    found = margins(GRID, open_loop(paper_model, wsc(lead(36, 40, "dc"))), 2)
    assert found.sensitivity_peak == pytest.approx(31.7, abs=0.5)
    assert found.sensitivity_peak_hz == pytest.approx(44.7, abs=0.1)


@pytest.mark.parametrize("part", [None, lead(36, 40), NOTCH])
def test_margins_against_python_control(paper_model: Model, part: Lead | Notch | None) -> None:
    loop = open_loop(paper_model, wsc(part))
    found = margins(GRID, loop, 2)
    data = control.FrequencyResponseData(loop, 2 * np.pi * GRID)
    gain, phase, modulus, *_ = control.stability_margins(data, returnall=True)
    assert 1 / found.sensitivity_peak == pytest.approx(np.min(modulus), rel=1e-3)
    assert found.gain_margin_db == pytest.approx(np.min(np.abs(20 * np.log10(gain))), abs=0.05)
    turns = np.abs((np.asarray(phase) + 180) % 360 - 180)
    assert found.phase_margin_deg == pytest.approx(np.min(turns), abs=0.1)


def closed_loop_poles(parts: Wsc) -> np.ndarray:
    """Poles of the sampled loop: exact zero-order hold of the paper's plant, whole samples of dead time.

    In state space: the many poles near z = 1 are lost to rounding in a product of polynomials.
    """
    step = 0.001
    plant = control.tf(paper_plant.NUMERATORS["motor_speed_rad_s"], paper_plant.DENOMINATOR)
    loop = control.sample_system(control.ss(plant), step, "zoh")
    late = control.ss(np.eye(8, k=-1), np.eye(8, 1), np.eye(8)[-1:], [[0]], step)
    loop = control.series(late, loop)
    for block in feedback_functions(parts):
        top, bottom = signal.bilinear(block.numerator, block.denominator, 1 / step)
        loop = control.series(control.ss(control.tf(top, bottom, step)), loop)
    return np.asarray(control.feedback(loop, 1).poles())


@given(st.floats(0.3, 12.0), st.sampled_from([None, lead(36, 40), lead(50, 25, "centre"), NOTCH]))
@settings(max_examples=40, deadline=None)
def test_nyquist_agrees_with_the_closed_loop_poles(gain: float, part: Lead | Notch | None) -> None:
    model = Model(
        "transfer_function",
        transfer_functions={
            name: TransferFunction(top, paper_plant.DENOMINATOR, 0.008)
            for name, top in paper_plant.NUMERATORS.items()
        },
    )
    parts = wsc(part, gain)
    poles = np.abs(closed_loop_poles(parts))
    if np.min(np.abs(poles - 1)) < 2e-5:
        return  # too near to call
    found = encirclements(open_loop(model, parts, 0.001), 2)
    assert (found == 0) == bool(np.all(poles < 1))


def test_delay_margin_is_what_destabilises(paper_model: Model) -> None:
    loop = open_loop(paper_model, wsc(lead(36, 40, "centre")))
    allowed = margins(GRID, loop, 2).delay_margin_s
    for factor, stable in ((0.98, True), (1.02, False)):
        late = loop * np.exp(-2j * np.pi * GRID * allowed * factor)
        assert margins(GRID, late, 2).stable is stable
