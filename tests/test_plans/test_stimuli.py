from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from scipy import signal

from test_plans import stimuli

DT = 0.001


@pytest.mark.parametrize("sweep", ["linear", "logarithmic"])
def test_chirp_is_scipys(sweep: stimuli.Sweep) -> None:
    ours = stimuli.chirp(0.05, 30.0, 40.0, 20.0, DT, sweep=sweep)
    time = np.arange(40_000) * DT
    assert_allclose(ours, 20 * signal.chirp(time, 0.05, 40.0, 30.0, method=sweep, phi=-90), atol=1e-7)


def test_chirp_from_zero_hertz() -> None:
    ours = stimuli.chirp(0.0, 10.0, 5.0, 1.0, DT, sweep="linear")
    assert_allclose(ours, np.sin(2 * np.pi * (np.arange(5000) * DT) ** 2), atol=1e-9)


def test_chirp_fades_in_and_out_with_its_bias() -> None:
    plain = stimuli.chirp(1.0, 20.0, 10.0, 8.0, DT, bias=12.0)
    faded = stimuli.chirp(1.0, 20.0, 10.0, 8.0, DT, bias=12.0, fade_s=1.0)
    assert faded[0] == 0.0
    assert faded[-1] == 0.0
    assert_array_equal(faded[1000:-1000], plain[1000:-1000])
    assert np.all(faded >= 0)
    assert np.max(np.abs(np.diff(faded))) <= np.max(np.abs(np.diff(plain))) + 12 * np.pi / 2 * DT


def test_multisine_has_its_lines_and_no_others() -> None:
    lines = stimuli.multisine_lines(0.5, 30.0, 4.0, odd_only=True)
    assert lines[0] == 3
    assert lines[-1] == 119
    period = stimuli.multisine(lines, 4.0, 1, 7, DT, rms=5.0)
    spectrum = np.abs(np.fft.rfft(period)) / len(period)
    present = np.flatnonzero(spectrum > 1e-9)
    assert_array_equal(present, lines)
    assert_allclose(spectrum[present], spectrum[present][0])
    assert_allclose(np.sqrt(np.mean(period**2)), 5.0)


def test_multisine_amplitude_bias_and_periods() -> None:
    lines = stimuli.multisine_lines(1.0, 10.0, 2.0)
    three = stimuli.multisine(lines, 2.0, 3, 1, DT, amplitude=20.0, bias=30.0)
    assert_allclose(np.max(np.abs(three - 30.0)), 20.0)
    assert_array_equal(three[:2000], three[2000:4000])
    assert_array_equal(three[:2000], three[4000:])


def test_multisine_fades_lie_outside_of_the_periods() -> None:
    lines = stimuli.multisine_lines(1.0, 10.0, 2.0)
    plain = stimuli.multisine(lines, 2.0, 2, 1, DT, rms=5.0)
    faded = stimuli.multisine(lines, 2.0, 2, 1, DT, rms=5.0, fade_s=0.5)
    assert len(faded) == len(plain) + 1000
    assert_array_equal(faded[500:-500], plain)
    assert faded[0] == faded[-1] == 0.0


def test_multisine_phases_depend_on_the_seed_alone() -> None:
    lines = stimuli.multisine_lines(1.0, 10.0, 2.0)
    one, same, other = (stimuli.multisine(lines, 2.0, 1, seed, DT, rms=1.0) for seed in (1, 1, 2))
    assert_array_equal(one, same)
    assert not np.allclose(one, other)


def test_lines_include_both_edges() -> None:
    assert stimuli.multisine_lines(0.1, 0.3, 10.0) == [1, 2, 3]
    assert stimuli.multisine_lines(0.0, 0.3, 10.0) == [1, 2, 3]


def test_step_ramp_and_stairs() -> None:
    assert_array_equal(stimuli.step(0.0, 5.0, 0.002, 0.003, DT), [0, 0, 5, 5, 5])
    assert_allclose(stimuli.ramp(0.0, 4.0, 0.001, 0.004, 0.002, DT), [0, 0, 1, 2, 3, 4, 4])
    assert_array_equal(stimuli.stairs([1.0, -2.0], [0.002, 0.001], DT), [1, 1, -2])


@given(st.integers(1, 500), st.data())
def test_fades_are_symmetric_and_between_zero_and_one(samples: int, data: st.DataObject) -> None:
    fade = data.draw(st.integers(0, samples // 2))
    envelope = stimuli.fades(samples, fade)
    assert_array_equal(envelope, envelope[::-1])
    assert np.all((envelope >= 0) & (envelope <= 1))
    assert_array_equal(envelope[fade : samples - fade], 1.0)
