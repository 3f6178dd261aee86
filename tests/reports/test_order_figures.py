"""Waterfall and tracked orders: of a run-up whose order and resonance are known."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hil.core.recording import Recording
from hil.core.result import Segment
from reports.figure import Figure
from reports.order_figures import order_amplitude, order_section
from reports.plotly_figure import plotly_figure
from reports.svg_figure import svg_figure

TIME = np.arange(12_001) / 1000
SPEED = 5.0 + 1.5 * TIME  # rad/s, to 23
ANGLE = 5.0 * TIME + 0.75 * TIME**2
ORDER, AMPLITUDE_NM, RESONANCE_HZ = 3.0, 30.0, 20.0
TORQUE = 300.0 + AMPLITUDE_NM * np.sin(ORDER * ANGLE + 0.4) + 8.0 * np.sin(2 * np.pi * RESONANCE_HZ * TIME)


def recorded(speed: np.ndarray = SPEED) -> Recording:
    channels = {"time_s": TIME, "shaft_torque_nm": TORQUE, "wheel_speed_rad_s": speed}
    return Recording(channels, Path("run-up"))


def segment(**changes: object) -> Segment:
    return Segment(id="run_up", start_s=0.0, step_s=0.5, end_s=12.0, wheel_orders=(ORDER,)).model_copy(
        update=changes
    )


def figures(**changes: object) -> tuple[Figure, ...]:
    section = order_section(recorded(), [segment(**changes)])
    assert section is not None
    return section.figures


def test_an_order_has_its_amplitude_at_every_speed() -> None:
    _, tracked = figures()
    (trace,) = tracked.traces
    assert trace.y == pytest.approx(AMPLITUDE_NM, rel=0.05)
    assert trace.x[0] >= 2 * 2 * np.pi / ORDER
    assert trace.x[-1] == pytest.approx(SPEED[-1] - 0.75, abs=0.8)


@pytest.mark.parametrize("order", [1.0, 2.5, 4.0])
def test_alone_it_is_found_exactly_and_others_are_not(order: float) -> None:
    first, last = 6000, 8000
    rows = slice(first, last)
    alone = 10.0 + 3.0 * TIME + 5.0 * np.cos(order * ANGLE)
    assert order_amplitude(TIME[rows], alone[rows], SPEED[rows], order) == pytest.approx(5.0, rel=1e-3)
    assert order_amplitude(TIME[rows], alone[rows], SPEED[rows], order + 2.0) < 0.3


def test_in_the_waterfall_the_order_moves_and_the_resonance_stays() -> None:
    fall, _ = figures()
    spectra, line = fall.traces
    assert line.x == pytest.approx(ORDER * line.y / (2 * np.pi))
    ends = [*np.flatnonzero(np.isnan(spectra.x)), len(spectra.x)]
    assert len(ends) == 16
    first = 0
    for end in ends:
        frequency, height = spectra.x[first:end], spectra.y[first:end]
        speed = height.min()
        peak = frequency[np.argmax(height)]
        assert peak == pytest.approx(ORDER * speed / (2 * np.pi), abs=1.1)
        near = np.abs(frequency - RESONANCE_HZ) < 1.5
        assert height[near].max() > speed
        first = end + 1


def test_a_steady_speed_and_an_axle_without_orders() -> None:
    assert order_section(recorded(10.0 + 0.0 * TIME), [segment()]) is None
    assert order_section(recorded(), [segment(wheel_orders=())]) is None
    assert order_section(recorded(), [segment(step_s=11.0)]) is None


def test_they_can_be_drawn() -> None:
    for figure in figures():
        assert b"<svg" in svg_figure(figure)
        assert plotly_figure(figure)
