"""Numbers of the base that moved: which are wrong, and whether most were far off."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from hil.analysis.missing_effects._candidates import Candidates
from hil.analysis.missing_effects._fit import Linearised, Point, point_at
from hil.analysis.missing_effects._hypothesis import TOLERANCE, Hypothesis, is_loss
from hil.analysis.missing_effects._odds import Candidate
from hil.analysis.missing_effects._outcome import Named
from hil.analysis.missing_effects._problem import Problem
from hil.analysis.missing_effects._screen import NUMBERS
from hil.analysis.missing_effects._search import HALF
from hil.analysis.missing_effects._spectrum import RIGHT_TO
from hil.core.effects import EFFECTS
from hil.core.model import EffectUse, Model


def numbers_of(at: Linearised, asked: Model) -> dict[str, tuple[float, float, float]]:
    """Numbers of the base: as it came, as found, standard error."""
    as_it_came = Hypothesis.alone(asked).numbers
    return {
        name: (float(as_it_came[name]), float(value), at.standard_error(-1, name))
        for name, value in at.point.hypothesis.numbers.items()
    }


def as_known(
    problem: Problem, numbers: Mapping[str, tuple[float, float, float]]
) -> dict[str, tuple[float, float, float]]:
    """Numbers with errors that no fit gets below: no model is right to more, so no number is known better.

    The shaft torque of a rigid axle leaps, and tells the dead time to a sample.
    """
    leaps = problem.model.kind == "rigid" and any(one.has[2] for one in problem.series)
    sample_s = {"torque_delay": problem.series[0].dt / np.sqrt(12.0)} if leaps else {}
    return {
        name: (base, value, float(np.hypot(error, sample_s.get(name, RIGHT_TO * abs(value)))))
        for name, (base, value, error) in numbers.items()
    }


def is_far(numbers: Mapping[str, tuple[float, float, float]], done: Candidates) -> bool:
    """Whether most of the numbers that the data fix are not what the base says.

    The prior alone leaves 0.7 of a tolerance.
    """
    known = [_off(name, numbers, done) for name in numbers]
    fixed = [moved for moved, error in known if error < HALF]
    return len(fixed) > 1 and sum(moved > 1.0 for moved in fixed) > HALF * len(fixed)


def mismatches(
    done: Candidates,
    numbers: Mapping[str, tuple[float, float, float]],
    best: Candidate,
    as_the_base: frozenset[str],
    gains: Mapping[str, tuple[str, ...]],
    weighed: Sequence[tuple[Candidate, float]],
) -> list[Named]:
    """Numbers that are wrong by more than their tolerance and doubt, each with the probability of that.

    Hypotheses count (`weighed`, by their posterior), each by how far the number moved in it. It is shared
    with `gains` that explain the data as well. Beside an effect, which bends numbers as well, those that are
    effects by themselves: a dead time, a drag. One that moves no channel by more than what no model is right
    to says nothing.
    """
    from scipy.special import ndtr

    found = []
    known = as_known(done.problem, numbers)
    for name, (_, value, error) in known.items():
        if best.names and (name in as_the_base or not _stands_beside(name, best, done.problem.model)):
            continue
        moved, doubt = _off(name, known, done)
        alike = gains.get(name, ())
        sure = 0.0
        for one, weight in weighed:
            stands_in = not {*alike}.isdisjoint(one.names)
            here = moved if stands_in else _away(name, one.point.hypothesis.numbers[name], done)
            sure += weight * float(ndtr((here - 1.0) / max(doubt, 1e-12)))
        if sure >= HALF and moved - 1.0 > doubt and _shows(done.problem, best.point, name):
            found.append(
                Named(
                    EffectUse("parameter_mismatch", {"parameter": name, "value": value}),
                    sure,
                    {"value": error},
                    alike,
                    EFFECTS[alike[0].partition("(")[0]].shown_by if alike else "",
                )
            )
    return found


def _off(
    name: str, numbers: Mapping[str, tuple[float, float, float]], done: Candidates
) -> tuple[float, float]:
    """How far a number moved and how sure that is, both in tolerances."""
    base, found, error = numbers[name]
    return _away(name, found, done), error / tolerance(name, base, done)


def is_off(name: str, hypothesis: Hypothesis, done: Candidates) -> bool:
    """Whether a number is not what the base says by more than its tolerance."""
    return _away(name, hypothesis.numbers[name], done) > 1.0


def _away(name: str, found: float, done: Candidates) -> float:
    """How far a number is from what the base says, in tolerances."""
    base = done.problem.as_it_came.numbers[name]
    return abs(found - base) / tolerance(name, base, done)


def tolerance(name: str, base: float, done: Candidates) -> float:
    """Of a number of the base, in its unit."""
    size = abs(base) or done.problem.scales[name]  # only numbers that have a scale may be zero
    return float(done.problem.model.tolerance.get(name, TOLERANCE) * size)


def _stands_beside(name: str, best: Candidate, base: Model) -> bool:
    """Whether a number that moved is an effect of its own beside others: a dead time, a drag.

    A drag beside another loss is one where the base has none: what a friction's law gets wrong bends it.
    """
    loses = any(is_loss(use) for use in best.point.hypothesis.terms)
    bent = name == NUMBERS["viscous_drag"] and loses and base.parameters[name] > 0.0
    return name in NUMBERS.values() and not bent


def _shows(problem: Problem, point: Point, name: str) -> bool:
    """Whether a number of the base put back moves a channel by more than what no model is right to."""
    as_it_came = point.hypothesis.with_number(name, problem.as_it_came.numbers[name])
    back = point_at(problem, as_it_came, point.starts)
    pairs = zip(back.errors, point.errors, strict=True)
    moved = problem.mean_square([one - other for one, other in pairs])
    return bool(np.nanmax(moved / np.maximum(problem.signal, 1e-300)) > RIGHT_TO**2)
