"""Where something acts, and what is left, in words."""

from dataclasses import replace

import numpy as np
import pytest

from hil.analysis.diagnosis.data._gap import gap_map
from hil.analysis.diagnosis.fit._coordinates import Hypothesis
from hil.analysis.diagnosis.fit._fit import fit
from hil.analysis.diagnosis.fit._simulated import simulated_samples
from hil.analysis.diagnosis.tell._words import _speeds_differ, signature, where
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


@pytest.mark.parametrize(
    ("speeds", "differ"),
    [
        ((100.0, 100.0), False),
        ((90.0, 110.0), False),
        ((50.0, 150.0), True),
        ((0.0, 100.0), True),
        ((0.0, 0.0), False),
    ],
)
def test_only_other_speeds_tell_whether_a_line_follows_them(
    speeds: tuple[float, float], differ: bool
) -> None:
    problem = one_problem()
    trace = problem.traces[0]
    measured = trace.measured.copy()
    measured[:, 0] = np.linspace(*speeds, len(measured))
    assert _speeds_differ(replace(problem, traces=(replace(trace, measured=measured),))) == differ
