from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy import signal

from hil.analysis.frequency_response import (
    Experiment,
    FrequencyResponse,
    averaged_spectra,
    estimate,
    experiments_of,
)
from hil.core.channels import OUTPUTS
from hil.core.recording import Recording
from tests.hil.analysis import paper_plant


def normalised_errors(frf: FrequencyResponse) -> np.ndarray:
    truth = np.array([paper_plant.response(name, frf.frequency_hz) for name in frf.outputs])
    return np.asarray(np.abs(frf.response - truth) / frf.standard_deviation)


def test_stated_uncertainty_is_the_real_one(paper_frf: FrequencyResponse) -> None:
    rms = np.sqrt(np.mean(normalised_errors(paper_frf) ** 2, axis=1))
    assert np.all((rms > 0.85) & (rms < 1.2)), rms


def test_noise_density_is_the_one_that_was_added(
    paper_frf: FrequencyResponse, paper_recording: Recording
) -> None:
    above = paper_frf.frequency_hz > 1.0
    for row, name in enumerate(OUTPUTS):
        added = 0.01 * np.std(paper_recording[name]) * np.sqrt(2 * paper_plant.STEP_S)
        found = np.median(paper_frf.noise[row, above])
        assert found == pytest.approx(added, rel=0.05)


def test_band_is_covered_to_both_ends(paper_frf: FrequencyResponse) -> None:
    assert paper_frf.frequency_hz[0] == 0.05
    assert paper_frf.frequency_hz[-1] == 30.0
    assert len(paper_frf.frequency_hz) > 300


def test_gained_speed_does_not_leak() -> None:
    """A constant torque beside the chirp makes the speeds ramp up; the response must not notice."""
    torque = paper_plant.chirp(100.0) + 12.0
    frf = estimate(experiments_of(paper_plant.recording(torque, noise=0.0)))
    truth = paper_plant.response(OUTPUTS[0], frf.frequency_hz)
    below = frf.frequency_hz < 28  # at its very end the chirp cannot be told from its leakage
    assert np.max(np.abs(frf.of(OUTPUTS[0]) / truth - 1)[below]) < 0.003


def test_experiments_of_unequal_length_and_rate_merge() -> None:
    long = experiments_of(paper_plant.recording(paper_plant.chirp(120.0), seed=1))[0]
    short = experiments_of(paper_plant.recording(paper_plant.chirp(80.0), seed=2))[0]
    slow = replace(short, input=short.input[::2], outputs=short.outputs[:, ::2], sample_time_s=0.002)
    alone = estimate([long], from_hz=0.1, to_hz=20)
    merged = estimate([long, slow], from_hz=0.1, to_hz=20)
    assert np.median(merged.standard_deviation[0]) < np.median(alone.standard_deviation[0])
    rms = np.sqrt(np.mean(normalised_errors(merged) ** 2, axis=1))
    assert np.all(rms < 1.4)


def test_feedback_does_not_bias_the_joint_estimate() -> None:
    """Noise fed back makes the direct estimate wrong; dividing two responses to the reference does not."""
    rng = np.random.default_rng(3)
    step, pole, count = 0.001, 8.0, 120_000
    decay = np.exp(-pole * step)
    reference = signal.chirp(np.arange(count) * step, 0.1, count * step, 20.0, "logarithmic", phi=-90)
    disturbance = signal.lfilter([0.02], [1.0, -0.995], rng.standard_normal(count))
    torque, speed = np.zeros(count), np.zeros(count)
    state = 0.0
    for k in range(count):
        speed[k] = state + disturbance[k]
        torque[k] = reference[k] - 1.5 * speed[k]
        state = decay * state + (1 - decay) / pole * 10 * torque[k]
    loop = Experiment("loop", step, torque, speed[None, :], OUTPUTS[:1], reference=reference, hold_s=step)
    joint = estimate([loop], from_hz=0.2, to_hz=15)
    truth = 10 / (2j * np.pi * joint.frequency_hz + pole)
    assert "joint" in joint.method
    error = joint.response[0] / truth - 1
    assert abs(np.mean(error)) < 0.02
    assert np.sqrt(np.mean(np.abs(joint.response[0] - truth) ** 2 / joint.standard_deviation[0] ** 2)) < 1.4
    direct = averaged_spectra([loop], 0.2, 15)
    truth = 10 / (2j * np.pi * direct.frequency_hz + pole)
    assert abs(np.mean(direct.response[0] / truth - 1)) > 0.05


def test_reference_that_rests_is_not_used() -> None:
    recording = paper_plant.recording(paper_plant.chirp(80.0))
    recording.channels["driving_torque_ref_nm"] = np.zeros(len(recording.time_s))
    frf = estimate(experiments_of(recording))
    assert frf.method == "local polynomial"


def test_hold_is_not_counted_as_dead_time() -> None:
    """Held between samples, an integrator's output lags by half a sample; that is not the plant's."""
    rng = np.random.default_rng(0)
    torque = rng.standard_normal(40_000)
    speed = np.concatenate([[0.0], np.cumsum(torque)[:-1]]) * 0.001
    recording = Recording(
        {
            "time_s": np.arange(40_000, dtype=np.float64) * 0.001,
            "motor_torque_ref_nm": torque,
            "motor_speed_rad_s": speed,
        },
        Path("integrator"),
    )
    frf = estimate(experiments_of(recording), from_hz=0.5, to_hz=30)
    turn = np.angle(frf.response[0] * 2j * np.pi * frf.frequency_hz)
    assert np.max(np.abs(turn)) < 1e-6
