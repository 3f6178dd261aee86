"""Physics and noise in errors that are made of known parts."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from hil.analysis.diagnosis.data.coherence import Split, _is_fed_back, _spectra, split
from hil.analysis.diagnosis.data.noise import noise_levels
from hil.analysis.diagnosis.data.trace import trace_of
from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.fit.fit import Fit, fit
from hil.analysis.diagnosis.fit.problem import Problem, problem_of
from hil.core.model import Model
from tests.hil.analysis.diagnosis.reference_plant import BASE, Truth, recordings


@pytest.fixture(scope="module")
def problem() -> Problem:
    traces = [trace_of(r) for r in recordings(Truth(), 5, short=True, off=0.0)]
    return problem_of(traces, noise_levels(traces), BASE["gear_ratio"])


@pytest.fixture(scope="module")
def perfect(problem: Problem) -> Fit:
    return fit(problem, Hypothesis(Model("three_inertia", dict(BASE))), rounds=0)


def slow_noise(seed: int, size: int) -> np.ndarray:
    """Three independent channels, each white noise and as much again below 2 Hz."""
    rng = np.random.default_rng(seed)
    pole = np.exp(-2 * np.pi * 2.0 / 250.0)
    slow = lfilter([np.sqrt(1.0 - pole**2)], [1.0, -pole], rng.normal(size=(size + 2000, 3)), axis=0)[2000:]
    return rng.normal(size=(size, 3)) + slow


def with_errors(problem: Problem, one: Fit, extra: list[np.ndarray] | None = None) -> tuple[Split, Fit]:
    """As if the noise-free simulation of `one` had been measured with known errors."""
    made_of, traces = [], []
    for index, errors in enumerate(one.errors):
        e = slow_noise(index, len(errors.channels))
        if extra is not None:
            e = e + extra[index]
        trace, weights = problem.traces[index], problem.weights[index]
        measured = trace.measured + (e - errors.channels) / weights
        traces.append(replace(trace, measured=measured))
        made_of.append(replace(errors, rows=e.ravel()))
    made = replace(one, errors=tuple(made_of))
    again = problem_of(traces, problem.noise, problem.gear_ratio)
    return split(again.traces, again.weights, [e.channels for e in made_of]), made


def test_slow_noise_is_no_physics(problem, perfect):
    parts, _ = with_errors(problem, perfect)
    assert np.all(np.abs(parts.physics) < 5 * parts.deviation)
    assert parts.noise == pytest.approx(2.0, rel=0.15)


def test_what_two_channels_share_is_physics(problem, perfect):
    rng = np.random.default_rng(9)
    extra = []
    for errors in perfect.errors:
        common = 0.5 * rng.normal(size=len(errors.channels))
        extra.append(np.column_stack([common, -common, 0.0 * common]))
    parts, _ = with_errors(problem, perfect, extra)
    # closed form above 2 Hz: common power 0.25, squared, over common and white power
    assert parts.physics[0] == pytest.approx(0.25**2 / 1.25, rel=0.5)
    assert parts.physics[0] == pytest.approx(parts.physics[1], rel=0.3)
    assert parts.physics[0] > 4 * parts.deviation[0]
    assert abs(parts.physics[2]) < 5 * parts.deviation[2]


def test_a_gain_of_one_sensor_is_physics_of_that_channel(problem, perfect):
    extra = []
    for index, trace in enumerate(problem.traces):
        e = np.zeros((len(trace.measured), 3))
        e[:, 2] = 0.02 * trace.measured[:, 2] * problem.weights[index][2]
        extra.append(e)
    parts, _ = with_errors(problem, perfect, extra)
    power = np.concatenate(extra)[:, 2] ** 2
    assert parts.physics[2] == pytest.approx(power.mean(), rel=0.3)
    assert np.all(np.abs(parts.physics[:2]) < 5 * parts.deviation[:2])


def test_what_comes_and_goes_is_physics(problem, perfect):
    extra = []
    for trace in problem.traces:
        e = np.zeros((len(trace.measured), 3))
        length = len(e) // 8
        at = slice(3 * length, 4 * length)
        e[at, 2] = 8.0 * np.sin(2 * np.pi * 17.3 * trace.block_time_s[at])
        extra.append(e)
    parts, _ = with_errors(problem, perfect, extra)
    power = np.concatenate(extra)[:, 2] ** 2
    assert parts.physics[2] == pytest.approx(power.mean(), rel=0.3)


def test_a_drift_of_the_simulation_is_physics(problem, perfect):
    extra = []
    for trace in problem.traces:
        e = np.zeros((len(trace.measured), 3))
        e[:, 1] = 12.0 * trace.block_time_s / trace.block_time_s[-1]
        extra.append(e)
    parts, _ = with_errors(problem, perfect, extra)
    assert parts.physics[1] > 10.0


@pytest.mark.parametrize(("gain", "loop"), [(0.5, True), (0.0, False)])
def test_a_request_that_follows_a_channels_noise_is_a_loop(problem, perfect, gain, loop):
    """A proportional controller on the motor speed: above all modes nothing else moves both."""
    noises, traces = [], []
    for index, (trace, errors) in enumerate(zip(problem.traces, perfect.errors, strict=True)):
        e = np.random.default_rng(index).normal(size=errors.channels.shape)
        torque = trace.torque.copy()
        at_full_rate = np.repeat(e[:, 0], trace.block)
        torque[: len(at_full_rate)] -= gain * at_full_rate
        traces.append(replace(trace, torque=torque))
        noises.append(e)
    spectra = _spectra(traces, problem.weights, noises)
    products = np.einsum("kfi,kfj->fij", spectra, spectra.conj()) / len(spectra)
    assert [_is_fed_back(products, c, len(spectra)) for c in range(3)] == [loop, False, False]
