"""Angles told by a ripple: where noise of a speed lets an integrated one walk off."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hil.analysis.missing_effects._candidates import Candidates
from hil.analysis.missing_effects._fit import Point, fit, point_at, with_better_starts
from hil.analysis.missing_effects._hypothesis import Hypothesis
from hil.analysis.missing_effects._noise import proven_noise
from hil.analysis.missing_effects._phase import errors_of, tracked
from hil.analysis.missing_effects._problem import Problem, problem_of
from hil.analysis.missing_effects._search import _with_whole_orders
from hil.analysis.missing_effects._series import series_of
from hil.core.model import EffectUse, Model
from hil.core.recording import Recording
from hil.plant import simulate

_CHAIN = Model(
    "two_inertia",
    {
        "motor_inertia": 0.02,
        "gear_ratio": 8.0,
        "shaft_stiffness": 6000.0,
        "shaft_damping": 20.0,
        "vehicle_inertia": 250.0,
        "torque_delay": 0.0,
    },
)
_ORDER = 6.0


def _ripple(amplitude_nm: float) -> EffectUse:
    return EffectUse("motor_order_ripple", {"order": _ORDER, "amplitude_nm": amplitude_nm, "phase_rad": 0.4})


def _problem(seed: int) -> tuple[Problem, list[np.ndarray]]:
    """An axle with a ripple, its speeds read with 1.5 rad/s of noise, and the rotor's true angles."""
    hidden = Model("two_inertia", dict(_CHAIN.parameters), (_ripple(1.5),))
    time = np.arange(30_000) * 1e-3
    torque = 8.0 * np.sin(2.0 * np.pi * 0.1 * time) + 3.0
    channels = simulate(hidden, torque, 1e-3)
    rng = np.random.default_rng(seed)
    noise = {"motor_speed_rad_s": 1.5, "wheel_speed_rad_s": 0.2, "shaft_torque_nm": 1.0}
    shown = {name: channels[name] + rng.normal(0.0, off, len(time)) for name, off in noise.items()}
    series = series_of(
        _CHAIN, [Recording({"time_s": time, "motor_torque_ref_nm": torque} | shown, Path("noisy.csv"))]
    )
    levels = proven_noise(series, {})
    angle = np.concatenate([[0.0], np.cumsum(channels["motor_speed_rad_s"])[:-1] * 1e-3])
    return problem_of(_CHAIN, series, levels), [angle]


def _point(problem: Problem, amplitude_nm: float) -> Point:
    hypothesis = Hypothesis(_CHAIN, dict(_CHAIN.parameters)).with_term(_ripple(amplitude_nm))
    return with_better_starts(problem, point_at(problem, hypothesis))


@pytest.mark.parametrize("seed", [1, 2])
def test_a_ripple_tells_the_angle_that_noise_lets_walk_off(seed: int) -> None:
    problem, (angle,) = _problem(seed)
    followed, _ = tracked(problem, _point(problem, 1.5))

    def off(one: Problem) -> float:  # beside what an order and a phase that are off do alike
        rows = np.stack([angle, np.ones(len(angle))], axis=1)
        away = one.angles[0][:, 1] - angle
        return float(np.sqrt(np.mean((away - rows @ np.linalg.lstsq(rows, away, rcond=None)[0]) ** 2)))

    assert off(problem) > 0.05
    assert off(followed) < 0.4 * off(problem)
    fitted = fit(followed, _point(followed, 1.5))  # order and phase move with their angles
    assert followed.mean_square(fitted.errors)[0] < 1.3 * problem.noise[0] ** 2


def test_a_ripple_that_shows_nothing_moves_no_angle() -> None:
    problem, _ = _problem(1)
    (before,), (after,) = (tracked(problem, _point(problem, size))[0].angles for size in (1e-9, 1e-8))
    assert np.max(np.abs(after - before)) < 1e-3


@pytest.mark.parametrize("seed", range(3, 7))
def test_an_order_is_known_as_far_as_angles_are(seed: int) -> None:
    """From an order that is off, fits and angles by turns end within errors that are small."""
    problem, _ = _problem(seed)
    done = Candidates(problem)
    begins = Hypothesis(_CHAIN, dict(_CHAIN.parameters)).with_term(_ripple(1.4))
    best = done.fitted(begins.with_values(0, {"order": _ORDER - 3e-3}, frozenset()), None)
    for _ in range(4):
        best = done.go_on_from(best)
        best = done.fitted(best.point.hypothesis, best)
    errors = errors_of(done.problem, best.point, best.point.hypothesis.terms[0])
    found = best.point.hypothesis.terms[0].values
    assert abs(float(found["order"]) - _ORDER) < 3.0 * errors["order"]
    assert abs(float(found["phase_rad"]) - 0.4) < 3.0 * errors["phase_rad"]
    assert 1e-4 < errors["order"] < 2e-2


def test_an_order_below_one_has_no_whole_one_beside_it() -> None:
    """Nothing turns by no period a turn."""
    problem, _ = _problem(1)
    slow = EffectUse("motor_order_ripple", {**_ripple(1.5).values, "order": 0.04})
    hypothesis = Hypothesis(_CHAIN, dict(_CHAIN.parameters)).with_term(slow)
    done = Candidates(problem)
    best = done.judged(point_at(problem, hypothesis))
    assert _with_whole_orders(done, best) is best
