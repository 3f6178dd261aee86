"""Noise is what rest, repeats, the spectrum or a data sheet say, not what is left over."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from hil.analysis.diagnosis.data.coherence import Split
from hil.analysis.diagnosis.data.noise import proven_noise
from hil.analysis.diagnosis.data.thresholds import SLOW_UNPROVEN
from hil.analysis.diagnosis.data.trace import Trace, blocks
from tests.hil.analysis.diagnosis.one_recording import NOISE, one_trace

WHITE = np.array(NOISE)
UNPROVEN = 1.0 + 4 * (SLOW_UNPROVEN**2 - 1.0)


def slow(seed: int, samples: int, corner_hz: float = 1.0) -> np.ndarray:
    """Low-passed noise of variance one in each of three channels."""
    pole = np.exp(-2 * np.pi * corner_hz * 1e-3)
    noise = np.random.default_rng(seed).normal(size=(samples + 5000, 3))
    return np.asarray(lfilter([np.sqrt(1 - pole**2)], [1.0, -pole], noise, axis=0)[5000:])


def with_samples(trace: Trace, samples: np.ndarray, torque: np.ndarray | None = None) -> Trace:
    shown = trace.torque if torque is None else torque
    return replace(trace, samples=samples, measured=blocks(samples, trace.block), torque=shown)


def test_the_spectrum_alone_proves_white_noise_and_little_more():
    assert proven_noise([one_trace()], WHITE) == pytest.approx(UNPROVEN)


def test_rest_proves_slow_noise():
    trace = one_trace(seconds=12.0)
    torque, samples = trace.torque.copy(), np.zeros_like(trace.samples)
    torque[4000:] = 0.0
    samples[:4000, :2] = 800.0 * np.sin(np.arange(4000) / 200.0)[:, None]
    samples += 3.0 * WHITE * slow(4, len(samples))
    found = proven_noise([with_samples(trace, samples, torque)], WHITE)
    # slow noise does not average out: 4 times its variance in units of a block mean
    assert found == pytest.approx(SLOW_UNPROVEN**2 * 4 * 9, rel=0.5)


def test_an_axle_that_coasts_does_not_rest():
    trace = one_trace(seconds=12.0)
    torque, samples = trace.torque.copy(), np.zeros_like(trace.samples)
    torque[4000:] = 0.0
    samples[:, :2] = np.linspace(100.0, 40.0, len(samples))[:, None]
    assert proven_noise([with_samples(trace, samples, torque)], WHITE) == pytest.approx(UNPROVEN)


def test_repeats_prove_slow_noise_and_other_requests_do_not():
    trace = one_trace(seconds=8.0)
    noisy = [with_samples(trace, trace.samples + 3.0 * WHITE * slow(i, len(trace.samples))) for i in (1, 2)]
    found = proven_noise(noisy, WHITE)
    assert found == pytest.approx(SLOW_UNPROVEN**2 * 4 * 9, rel=0.5)
    other = replace(noisy[1], torque=noisy[1].torque * 1.01)
    assert proven_noise([noisy[0], other], WHITE) == pytest.approx(UNPROVEN)


def test_a_stated_noise_counts_for_its_channel():
    found = proven_noise([one_trace()], WHITE, {"wheel_speed_rad_s": 5 * NOISE[1]})
    assert found == pytest.approx([UNPROVEN, 4 * 25 * SLOW_UNPROVEN**2, UNPROVEN])


def test_what_is_above_the_proven_noise_is_physics_and_what_is_below_the_white_is_not():
    parts = Split(np.array([0.0, 1.0, 0.6, 0.5]), np.array([9.0, 2.0, 0.5, 0.1]), np.zeros(4))
    parts = parts.within(np.full(4, 3.0), np.ones(4))
    assert parts.physics == pytest.approx([6.0, 1.0, 0.1, 0.0])
    assert parts.noise == pytest.approx([3.0, 2.0, 1.0, 0.6])
