"""Order and phase of a ripple are known no better than the angle that they count from."""

import dataclasses

import numpy as np
import pytest

from hil.analysis.diagnosis.fit.errors import Errors
from hil.analysis.diagnosis.fit.fit import Fit
from hil.analysis.diagnosis.fit.problem import Problem
from hil.analysis.diagnosis.search.wandering import with_wandering
from hil.core.model import EffectUse
from tests.hil.analysis.diagnosis.one_recording import left, one_problem

RECORDINGS, WALK = 6, 0.02  # rad of phase in a root second
RIPPLE = EffectUse("wheel_order_disturbance", {"order": 3.0, "amplitude_nm": 10.0, "phase_rad": 0.0})


def several(problem: Problem) -> Problem:
    """The recording of `problem` several times, the wheel turning faster and slower."""
    count = len(problem.traces[0].torque)
    time = np.arange(count) * problem.traces[0].dt
    samples = problem.traces[0].samples.copy()
    samples[:, 1] = 8.0 + 6.0 * np.sin(time)
    samples[:, 0] = problem.gear_ratio * samples[:, 1]
    trace = dataclasses.replace(problem.traces[0], samples=samples)
    return dataclasses.replace(
        problem,
        traces=(trace,) * RECORDINGS,
        weights=problem.weights * RECORDINGS,
        angles=(trace.angles(problem.gear_ratio),) * RECORDINGS,
    )


def explained(problem: Problem) -> Fit:
    """A fit of the ripple that leaves nothing of any recording."""
    one = left(1.0, RIPPLE, rows=3)
    count = len(one.theta)
    errors = [
        Errors(np.zeros(rows), np.zeros((rows, count)), np.zeros((rows, 3)))
        for rows in (3 * len(t.measured) for t in problem.traces)
    ]
    return dataclasses.replace(one, errors=tuple(errors), angles=problem.angles)


def tracked(problem: Problem, seed: int) -> tuple[Fit, float]:
    """A fit whose angles were turned to a ripple behind walking angles, and how far its order is off."""
    rng = np.random.default_rng(seed)
    dt, angle = problem.traces[0].dt, problem.angles[0][:, 0]
    walks = [np.cumsum(rng.normal(0.0, WALK * np.sqrt(dt), len(angle))) for _ in range(RECORDINGS)]
    step = round(0.1 / dt)
    turned = np.diff(angle[::step])
    off = sum(turned @ np.diff(w[::step]) for w in walks) / (RECORDINGS * turned @ turned)
    fit = explained(problem)
    angles = []
    for walk in walks:
        one = problem.angles[0].copy()
        one[:, 0] += (walk - off * angle) / 3.0
        angles.append(one)
    return dataclasses.replace(fit, angles=tuple(angles)), float(off)


def test_an_order_is_known_as_well_as_its_angle() -> None:
    problem = several(one_problem(seconds=8.0))
    ratios = []
    for seed in range(40):
        fit, off = tracked(problem, seed)
        found = with_wandering(problem, fit)
        assert found.scatter is not None
        index = [c.name for c in fit.hypothesis.coordinates()].index("order")
        ratios.append(off / found.scatter[index])
    assert 0.6 < np.sqrt(np.mean(np.square(ratios))) < 1.2


def test_a_phase_is_known_as_well_as_the_recordings_agree() -> None:
    problem = several(one_problem(seconds=8.0))
    names = [c.name for c in left(1.0, RIPPLE, rows=3).hypothesis.coordinates()]
    shifts = np.array([0.3, -0.3, 0.1, -0.1, 0.2, -0.2])
    angles = [a + np.array([s / 3.0, 0.0]) for a, s in zip(problem.angles, shifts, strict=True)]
    fit = dataclasses.replace(explained(problem), angles=tuple(angles))
    scatter = with_wandering(problem, fit).scatter
    assert scatter is not None
    assert scatter[names.index("phase_rad")] == pytest.approx(np.std(shifts, ddof=1) / np.sqrt(RECORDINGS))
    assert scatter[names.index("amplitude_nm")] == 0.0


def test_an_angle_counted_by_the_gear_ratio_is_as_uncertain_as_that() -> None:
    problem = one_problem(seconds=8.0)
    samples = problem.traces[0].samples.copy()
    samples[:, 1] = np.nan
    measured = problem.traces[0].measured.copy()
    measured[:, 1] = np.nan
    trace = dataclasses.replace(problem.traces[0], samples=samples, measured=measured)
    problem = dataclasses.replace(problem, traces=(trace,), angles=(trace.angles(problem.gear_ratio),))
    fit = explained(problem)
    scatter = with_wandering(problem, fit).scatter
    assert scatter is not None
    index = [c.name for c in fit.hypothesis.coordinates()].index("order")
    assert scatter[index] == pytest.approx(3.0 * 0.015)


def test_an_order_is_known_no_better_than_what_is_left_of_the_speed_lets_its_angle_walk() -> None:
    """A ripple too weak to be followed: angles stay as they were, and are as wrong as before."""
    problem = several(one_problem(seconds=8.0))
    fit = explained(problem)
    index = [c.name for c in fit.hypothesis.coordinates()].index("order")
    period, weight = problem.traces[0].dt * problem.traces[0].block, problem.weights[0][1]
    speed = problem.traces[0].measured[:, 1]
    ratios = []
    for seed in range(40):
        rng = np.random.default_rng(seed)
        errors, walked = [], 0.0
        for one in fit.errors:
            noise = rng.normal(0.0, 0.3, len(one.channels))
            rows = one.channels.copy()
            rows[:, 1] = noise * weight
            errors.append(dataclasses.replace(one, rows=rows.ravel()))
            walked += _slope(speed, noise, round(1.0 / period))
        found = with_wandering(problem, dataclasses.replace(fit, errors=tuple(errors)))
        assert found.scatter is not None
        ratios.append(3.0 * walked / RECORDINGS / found.scatter[index])
    assert 0.6 < np.sqrt(np.mean(np.square(ratios))) < 1.3


@pytest.mark.parametrize("measured", [0, 1])
def test_in_one_recording_alone_a_phase_is_known_no_better_than_its_angle_walks(measured: int) -> None:
    problem = one_problem(seconds=8.0)
    trace = problem.traces[0]
    gone = np.isnan(trace.samples) | (np.arange(3) == 1 - measured)
    lone = dataclasses.replace(
        trace,
        samples=np.where(gone, np.nan, trace.samples),
        measured=np.where(gone[: len(trace.measured)], np.nan, trace.measured),
    )
    problem = dataclasses.replace(problem, traces=(lone,))
    fit = explained(problem)
    off = np.zeros((len(trace.measured), 3))
    ratio = problem.gear_ratio if measured == 0 else 1.0
    off[:, measured] = 0.02 * ratio  # rad/s at the wheel: 0.16 rad in the end, evenly gained
    rows = (off * problem.weights[0]).ravel()
    fit = dataclasses.replace(fit, errors=(dataclasses.replace(fit.errors[0], rows=rows),))
    scatter = with_wandering(problem, fit).scatter
    assert scatter is not None
    index = [c.name for c in fit.hypothesis.coordinates()].index("phase_rad")
    assert scatter[index] == pytest.approx(3.0 * 0.16 / np.sqrt(3.0), rel=0.01)


def _slope(speed: np.ndarray, noise: np.ndarray, length: int) -> float:
    """Relative error of an angle by least squares through its steps."""
    whole = len(speed) // length * length
    turned, off = (v[:whole].reshape(-1, length).sum(axis=1) for v in (speed, noise))
    return float(turned @ off / (turned @ turned))


def test_without_a_ripple_nothing_wanders() -> None:
    problem = one_problem()
    scatter = with_wandering(problem, dataclasses.replace(left(1.0), angles=problem.angles)).scatter
    assert scatter is not None
    assert not scatter.any()
