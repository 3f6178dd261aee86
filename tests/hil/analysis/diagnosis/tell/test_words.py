"""Where something acts, and what is left, in words."""

from dataclasses import replace

import numpy as np

from hil.analysis.diagnosis.data.gap import CONDITIONS, GapMap, gap_map
from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.fit.fit import Fit, fit
from hil.analysis.diagnosis.fit.problem import Problem
from hil.analysis.diagnosis.fit.simulated import simulated_samples
from hil.analysis.diagnosis.tell.words import _dependence, signature, where
from hil.core.channels import OUTPUTS
from hil.core.model import EffectUse
from tests.hil.analysis.diagnosis.one_recording import MODEL, NOISE, one_problem

OFFSET = EffectUse("sensor_offset", {"channel": OUTPUTS[2], "offset": 20.0})


def test_a_wave_in_one_channel_is_placed() -> None:
    problem = one_problem()
    trace = problem.traces[0]
    wave = np.zeros_like(trace.samples)
    wave[:, 2] = 30.0 * np.sin(2 * np.pi * 10.0 * np.arange(len(wave)) * trace.dt)
    maps = [gap_map(problem.traces, np.array(NOISE), [s]) for s in (trace.samples - wave, trace.samples)]
    found = where(problem, [trace.samples - wave], [trace.samples], *maps)
    assert found.channels == (OUTPUTS[2],)
    assert found.band_hz[0] < 10.0 < found.band_hz[1]


def test_what_is_left_is_told_by_its_channel() -> None:
    problem = one_problem(OFFSET)
    one = fit(problem, Hypothesis(MODEL), rounds=0)
    shown = simulated_samples(problem, one.hypothesis, one.theta, one.starts)
    told = signature(problem, one, gap_map(problem.traces, problem.noise, shown))
    assert told.startswith(f"the gap is largest in {OUTPUTS[2]}")


def _left(problem: Problem, errors: list[np.ndarray]) -> Fit:
    """A fit that leaves these errors, blocks x 3 each recording."""
    one = fit(problem, Hypothesis(MODEL), rounds=0)
    kept = tuple(replace(e, rows=np.ravel(rows)) for e, rows in zip(one.errors, errors, strict=True))
    return replace(one, errors=kept)


def test_a_channel_that_was_not_recorded_is_never_the_worst() -> None:
    """What noise leaves of the others may be less than is expected of it: nothing is more than that."""
    problem = one_problem()
    trace = problem.traces[0]
    samples, measured = trace.samples.copy(), trace.measured.copy()
    samples[:, 1] = measured[:, 1] = np.nan
    problem = replace(problem, traces=(replace(trace, samples=samples, measured=measured),))
    errors = np.full(measured.shape, 0.9)
    errors[:, 1] = 0.0
    gaps = gap_map(problem.traces, problem.noise, [samples])
    words = signature(problem, _left(problem, [errors]), gaps)
    assert "largest in" in words
    assert OUTPUTS[1] not in words


def test_no_condition_is_the_strongest_of_one() -> None:
    problem = one_problem()
    errors = np.full(problem.traces[0].measured.shape, 2.0)
    by = np.full((len(CONDITIONS), 3), np.nan)
    by[3] = 5.0
    gaps = GapMap(("one",), np.full((1, 3, 7), 5.0), by)
    assert "strongest at" not in signature(problem, _left(problem, [errors]), gaps)


def test_recordings_that_are_alike_tell_no_dependence() -> None:
    problem = one_problem()
    four = replace(problem, traces=problem.traces * 4)
    errors = [
        np.random.default_rng(i).normal(0.0, 1.0 + i, problem.traces[0].measured.shape) for i in range(4)
    ]
    kept = replace(_left(problem, errors[:1]), errors=tuple(_left(problem, [e]).errors[0] for e in errors))
    assert _dependence(four, kept, 2) == ""
