"""A line in what is left: what is said of other recordings and speeds was compared."""

from dataclasses import replace

import numpy as np
import pytest

from hil.analysis.diagnosis.fit.errors import Errors
from hil.analysis.diagnosis.fit.fit import Fit
from hil.analysis.diagnosis.fit.problem import Problem
from hil.analysis.diagnosis.tell.drift import line_in_words, speeds_differ
from tests.hil.analysis.diagnosis.one_recording import left, one_problem

SHAFT = 2
PERIOD_S = 0.004
SECONDS = 32.0


def _case(
    *recordings: tuple[float, float], moving: float = 0.0, speed_known: bool = True
) -> tuple[Problem, Fit]:
    """Recordings whose rotor turns at `speed` (rad/s) and whose shaft errs in a line at `line` Hz.

    With `moving` the line goes with the speed, which grows to three times its first value.
    """
    problem, rng = one_problem(), np.random.default_rng(3)
    first, count = problem.traces[0], round(SECONDS / PERIOD_S)
    traces, errors = [], []
    for number, (speed, line) in enumerate(recordings):
        measured = np.tile(first.measured[:1], (count, 1))
        growth = 1.0 + moving * np.repeat(np.linspace(0.0, 2.0, 3), count // 3 + 1)[:count]
        measured[:, 0] = speed * growth if speed_known else np.nan
        measured[:, 1] = np.nan
        traces.append(
            replace(
                first, name=f"recording {number}", dt=PERIOD_S, block=1, measured=measured, samples=measured
            )
        )
        rows = rng.normal(0.0, 1.0, (count, 3))
        if line:
            rows[:, SHAFT] += 5.0 * np.sin(2 * np.pi * np.cumsum(line * growth) * PERIOD_S)
        errors.append(Errors(np.ravel(rows), np.zeros((3 * count, 0)), np.zeros((3 * count, 3))))
    return replace(problem, traces=tuple(traces)), replace(left(1.0), errors=tuple(errors))


def test_lines_of_recordings_that_differ_are_both_named() -> None:
    words = line_in_words(*_case((100.0, 52.2), (117.0, 61.0)), SHAFT)
    assert "52.2 Hz in recording 0" in words or "52.3 Hz in recording 0" in words
    assert "Hz in recording 1" in words
    assert "rotor" not in words
    assert "speed" not in words


def test_a_line_that_other_speeds_do_not_move_is_said_to_stay() -> None:
    words = line_in_words(*_case((100.0, 52.2), (200.0, 52.2)), SHAFT)
    assert "with the rotor at 100 rad/s as at 200 rad/s" in words


def test_a_line_in_one_of_two_recordings_is_in_that_one_alone() -> None:
    words = line_in_words(*_case((100.0, 52.2), (200.0, 0.0)), SHAFT)
    assert words.endswith("Hz in recording 0 alone")


def test_a_line_that_moves_within_a_recording_does_not_stay() -> None:
    words = line_in_words(*_case((100.0, 20.0), moving=1.0), SHAFT)
    assert "as at" not in words


def test_nothing_is_said_of_a_speed_that_was_not_measured() -> None:
    problem, kept = _case((100.0, 52.2), speed_known=False)
    assert speeds_differ(problem) is None
    words = line_in_words(problem, kept, SHAFT)
    assert words.startswith("it is a line at")
    assert "speed" not in words
    assert "rotor" not in words


def test_at_one_speed_it_says_so() -> None:
    assert line_in_words(*_case((100.0, 52.2)), SHAFT).endswith("at the one speed of these recordings")


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
    assert speeds_differ(replace(problem, traces=(replace(trace, measured=measured),))) == differ
