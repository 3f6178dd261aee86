"""Numbers that most of a recording agrees with."""

from dataclasses import replace

import numpy as np

from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.fit.fit import fit
from hil.analysis.diagnosis.search.predictable import _blocks_of_window, _with_aftermath
from hil.analysis.diagnosis.search.trimmed import trimmed
from tests.hil.analysis.diagnosis.one_recording import MODEL, one_problem


def test_a_stretch_that_is_not_the_models_bends_no_number():
    problem = one_problem(seconds=8.0)
    trace = problem.traces[0]
    measured = trace.measured.copy()
    late = np.arange(len(measured)) > 0.8 * len(measured)
    measured[late, 2] *= 1.3
    spoilt = replace(problem, traces=(replace(trace, measured=measured),))
    right = fit(problem, Hypothesis(MODEL))
    bent = fit(spoilt, Hypothesis(MODEL))
    found = trimmed(spoilt, bent)
    index = [c.name for c in right.hypothesis.coordinates()].index("shaft_stiffness")
    known = right.white_errors[index]
    assert abs(bent.theta[index] - right.theta[index]) > 6.0 * known
    assert abs(found.theta[index] - right.theta[index]) < 3.0 * known
    assert not spoilt.partial  # what it leaves is that of all
    assert found.rows == bent.rows
    assert found.total > bent.total


def test_what_follows_chaotic_motion_is_its_aftermath_as_long_as_much_is_left():
    problem = one_problem(seconds=8.0)
    one = fit(problem, Hypothesis(MODEL), rounds=0)
    length = _blocks_of_window(problem)
    count = len(one.errors[0].channels) // length
    channels = np.ones_like(one.errors[0].channels)
    channels[5 * length : 9 * length] = 20.0
    channels[12 * length : 13 * length] = 20.0
    one = replace(one, errors=(replace(one.errors[0], rows=channels.ravel()),))
    apart = np.zeros(count, bool)
    apart[5] = True
    less = np.zeros(count, bool)
    less[[2, 12]] = True
    assert np.flatnonzero(_with_aftermath(problem, one, [apart], [~less])[0]).tolist() == [5, 6, 7, 8]
    assert np.flatnonzero(_with_aftermath(problem, one, [apart], [less])[0]).tolist() == [5, 6, 7, 8, 12]
