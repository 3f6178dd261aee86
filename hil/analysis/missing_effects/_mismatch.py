"""Numbers of the base that moved: which are effects by themselves, and whether most were far off."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from hil.analysis.missing_effects._candidates import Candidates
from hil.analysis.missing_effects._fit import Linearised, Point, point_at
from hil.analysis.missing_effects._hypothesis import TOLERANCE, Hypothesis, is_loss
from hil.analysis.missing_effects._odds import ALIKE, Candidate
from hil.analysis.missing_effects._outcome import Named
from hil.analysis.missing_effects._problem import Problem
from hil.analysis.missing_effects._screen import NUMBERS, Scene, may_join
from hil.analysis.missing_effects._search import HALF
from hil.analysis.missing_effects._spectrum import RIGHT_TO
from hil.core.effects import EFFECTS, Effect
from hil.core.model import EffectUse, Model


def as_the_base_has(done: Candidates, best: Candidate) -> frozenset[str]:
    """Numbers that are effects by themselves and moved, though the data allow what the base says as well.

    A dead time beside friction that sticks has many minima, and a rigid axle shows it to a sample. So each
    is held where the base has it, once with all optional numbers and once with each of them left out; in
    hypotheses that the data do not tell from the best one as well.
    """
    hypothesis = best.point.hypothesis
    found = []
    for name in NUMBERS.values() if best.names else ():
        base = done.problem.model.parameters.get(name, 0.0)
        if base <= 0.0 or abs(hypothesis.numbers[name] - base) <= _tolerance(name, base, done):
            continue
        alike = [one for one in done.found.values() if done.score(one) > done.score(best) - ALIKE]
        begins = [one.point.hypothesis.with_number(name, base) for one in alike]
        fewer = [
            hypothesis.with_number(name, base).closed(index, optional)
            for index, opened in enumerate(hypothesis.opened)
            for optional in sorted(opened)
        ]
        ended = [done.fitted(one, best, held=frozenset({name})) for one in (*begins, *fewer)]
        if max(done.score(one) for one in ended) > done.score(best) - ALIKE:
            found.append(name)
    return frozenset(found)


def gains_instead(done: Candidates, best: Candidate) -> dict[str, tuple[str, ...]]:
    """Of each number that moved where nothing is named: gains that do as well with what the base has.

    A gear ratio and a gain of one of two speeds show the same: only the prior knows that teeth were counted.
    """
    if best.names:
        return {}
    hypothesis, found = best.point.hypothesis, {}
    for name in done.has_moved(best):
        back = hypothesis.with_number(name, done.problem.as_it_came.numbers[name])
        tried = [
            done.fitted(back.with_term(use), best, held=frozenset({name})) for use in gains_of(done, back)
        ]
        alike = [one for one in tried if done.score(one) > done.score(best) - ALIKE]
        found[name] = tuple(one.names[0] for one in sorted(alike, key=done.score, reverse=True))
    return found


def gains_of(done: Candidates, hypothesis: Hypothesis) -> list[EffectUse]:
    """Gains that may join, of each channel that was recorded, of one."""
    effects = [one for one in EFFECTS.values() if one.off == 1.0 and may_join(one, hypothesis)]
    return [use for one in effects for use in _on_each_channel(done, hypothesis, one)]


def twins_of(done: Candidates, hypothesis: Hypothesis, use: EffectUse) -> list[EffectUse]:
    """What may show the same as a gain, or as an error of a sensor, in its place: where it does nothing."""
    effect = EFFECTS[use.id]
    if effect.off == 1.0:
        return gains_of(done, hypothesis)
    return _on_each_channel(done, hypothesis, effect) if "channel" in use.values else []


def _on_each_channel(done: Candidates, hypothesis: Hypothesis, effect: Effect) -> list[EffectUse]:
    channels = Scene(done.problem, hypothesis).channels if effect.text_parameters else ()
    number: dict[str, float | str] = {effect.parameters[0].name: effect.off}
    return [EffectUse(effect.id, number | {"channel": name}) for name in channels] or [
        EffectUse(effect.id, number)
    ]


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
                    EFFECTS["sensor_gain"].shown_by if alike else "",
                )
            )
    return found


def _off(
    name: str, numbers: Mapping[str, tuple[float, float, float]], done: Candidates
) -> tuple[float, float]:
    """How far a number moved and how sure that is, both in tolerances."""
    base, found, error = numbers[name]
    return _away(name, found, done), error / _tolerance(name, base, done)


def _away(name: str, found: float, done: Candidates) -> float:
    """How far a number is from what the base says, in tolerances."""
    base = done.problem.as_it_came.numbers[name]
    return abs(found - base) / _tolerance(name, base, done)


def _tolerance(name: str, base: float, done: Candidates) -> float:
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
