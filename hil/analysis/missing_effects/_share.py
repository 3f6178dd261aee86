"""What an effect is worth of its name, and whether what was found lasts.

It is worth the share of the misfit beyond noise that goes with it: what it takes off over that and what
stays. That keeps a name modest where something without a name is larger: a discrepancy that stays can make up
a name that takes off less than itself.

An effect's number is let change in a straight line over each recording. Its change of the errors, beside
what all numbers and starts could do, takes α·d·r - ½ α²·d·d off the misfit (score test, C. R. Rao, Proc.
Cambridge Phil. Soc. 44 (1948) 50). Where that pays as one more number must, the effect is worth the share
that is always there: a gain that fades is no gain.

Octaves below the lines of a torque that repeats itself decide no name. A model without any loss still drifts
there, by many times what it should show, and whoever simulates it sees that and nothing else.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from hil.analysis.missing_effects._candidates import Candidates
from hil.analysis.missing_effects._fit import Linearised, Point, without
from hil.analysis.missing_effects._hypothesis import Hypothesis, is_linear, is_loss
from hil.analysis.missing_effects._odds import ALIKE, Candidate, remains
from hil.analysis.missing_effects._orders import is_held, turns
from hil.analysis.missing_effects._outcome import Replay
from hil.analysis.missing_effects._problem import Problem
from hil.analysis.missing_effects._screen import may_join
from hil.analysis.missing_effects._search import HALF
from hil.core.effects import EFFECTS
from hil.core.model import EffectUse, Model

Array = npt.NDArray[np.float64]

LAW = 0.02
"""Of what an effect takes off is right in no law that bends; nor are its numbers known better."""
_DRAGS = {"viscous_drag": "motor_inertia", "load_viscous_drag": "vehicle_inertia"}
_TIMES_S = np.geomspace(0.01, 100.0, 81)  # in which a drag would stop its inertia


@dataclass(frozen=True)
class Judged:
    """A search, the variance that a candidate leaves over all data, and recordings of both kinds.

    `asked` is the model as it came.
    """

    asked: Model
    done: Candidates
    left: Callable[[Candidate], Array]
    fitted: tuple[Replay, ...]
    held_out: tuple[Replay, ...]


def share_of(
    of: Judged, fewer: Candidate, best: Candidate, at: Linearised, index: int, wrong: Array | float = 0.0
) -> float:
    """What an effect takes off over that and what stays, where it lasts; 0 where its size is not known."""
    if not (_is_sized(at, index) and _is_line(of.done, at, index) and _turns_around(of.done, at, index)):
        return 0.0
    lasts = constancy(of.done.problem, at, index, of.done.cost_of_a_number(best))
    return (1.0 - _remains(of, fewer, best, wrong)) * lasts


def wrong_by_laws(of: Judged, best: Candidate, fewer: Sequence[Candidate], index: int) -> Array:
    """Variance in each channel, (3,), that others' laws may get wrong without an effect; not linear ones.

    A law that is wrong by a share leaves that of what it takes off in every channel, so no more than where
    least stays; and an effect that mends a law mends no more than half of it: as much stays.
    """
    left, alone = of.left(best), of.left(fewer[index])
    noise, most = of.done.problem.noise_in(best.point.errors)
    wrong = np.zeros(3)
    for other, use in enumerate(best.point.hypothesis.terms):
        if other != index and not is_linear(use):
            taken = np.maximum(of.left(fewer[other]) - left, 1e-300)
            wrong += min(LAW**2, float(np.nanmin(alone / taken))) * taken
    return np.minimum(wrong, np.maximum(left, most) - noise)


def _is_sized(at: Linearised, index: int) -> bool:
    """Whether a number by which an effect acts is known to half of itself.

    Nor is it friction where nothing but its offset acts, which has a sign.
    """
    use = at.point.hypothesis.terms[index]
    effect = EFFECTS[use.id]
    free = [name for name in effect.acting() if np.isfinite(at.standard_error(index, name))]
    names = [name for name in free if effect.parameter(name).lower >= 0.0] or free
    sizes = {name: abs(float(use.values[name]) - effect.off) for name in names}
    return not names or any(at.standard_error(index, name) < HALF * size for name, size in sizes.items())


def _turns_around(done: Candidates, at: Linearised, index: int) -> bool:
    """Whether a rotor turns so far that friction comes to its level, as far as laws are right.

    It nears that exponentially; over less of an angle it is a spring.
    """
    over = float(at.point.hypothesis.terms[index].values.get("turn_rad", 0.0))
    return -math.log(LAW) * over <= 2.0 * math.pi * turns(done.problem, "rotor")


def _is_line(done: Candidates, at: Linearised, index: int) -> bool:
    """Whether an effect follows no angle, or recordings hold periods of its order and tell it to half a one.

    A ripple of less than that takes up whatever is slow.
    """
    use = at.point.hypothesis.terms[index]
    side = EFFECTS[use.id].law.follows
    if side is None:
        return True
    whole = turns(done.problem, side)
    sure = at.standard_error(index, "order") * whole < HALF
    return sure and bool(is_held(np.array(float(use.values["order"])), whole))


def _remains(of: Judged, before: Candidate, after: Candidate, wrong: Array | float = 0.0) -> float:
    """Share of the variance beyond noise that stays; none where numbers of the base had explained it.

    Nor where all that stays may be slow noise, if of one channel half as much as that was taken off, and by
    more than fits to noise so slow bring. All of it where the score fell: what was dropped beside it paid.

    Args:
        wrong: variance that stays by what laws get wrong, (3,), of that which is taken off.
    """
    problem, done = of.done.problem, of.done
    if done.score(after) < done.score(before):
        return 1.0
    had, has = of.left(before), of.left(after)
    has = has + np.clip(had - has, 0.0, wrong)
    if after.prior - before.prior > ALIKE:
        had = np.fmax(had, of.left(done.at(_fewer(after.point.hypothesis, before.names), after)))
    there = np.isfinite(has)
    noise, most = problem.noise_in(after.point.errors)
    if np.all(has[there] <= most[there]):
        grew = after.log_likelihood - before.log_likelihood
        cost = grew - (done.score(after) - done.score(before))
        off, slow = (had - has)[there], np.maximum(has - noise, 0.0)[there]
        if grew / np.max((most / noise)[there]) > cost and np.any(off > HALF * slow):
            return 0.0
    return remains(had, has, noise, most)


def _fewer(hypothesis: Hypothesis, names: Sequence[str]) -> Hypothesis:
    """Its effects of these names alone, its numbers what they are."""
    for index in reversed(range(len(hypothesis.terms))):
        if hypothesis.names[index] not in names:
            hypothesis = hypothesis.without(index)
    return hypothesis


def constancy(problem: Problem, at: Linearised, index: int, cost: float) -> float:
    """Least size of an effect in a recording as a share of what it is in the mean, 0 to 1.

    Of several numbers those count that do as much: air at a walking pace says nothing of rolling.

    Args:
        index: of the effect.
        cost: growth of log L that one more number must bring.
    """
    effect = EFFECTS[at.point.hypothesis.terms[index].id]
    sizes, does = np.zeros((2, len(at.coordinates)))
    for place, one in enumerate(at.coordinates):
        size = abs(one.at(0.0) - effect.off)
        if one.term == index and one.name in effect.acting() and size < math.inf:
            sizes[place] = size / abs(one.slope(0.0))
            does[place] = sizes[place] * np.linalg.norm(at.slopes[:, place])
    least = 1.0
    for place in np.flatnonzero(does > HALF * np.max(does, initial=0.0)).tolist():
        gain, moved = _change(problem, at, place)
        if gain > cost:
            least = min(least, 1.0 - 0.5 * abs(moved) / sizes[place])
    return float(max(least, 0.0))


def _change(problem: Problem, at: Linearised, place: int) -> tuple[float, float]:
    """Growth of log L if a coordinate changes over each recording, and its change from end to end."""
    one, hypothesis = at.coordinates[place], at.point.hypothesis
    moved = hypothesis.moved([one], np.array([one.step]))
    both = [hypothesis.packed(), moved.packed()]
    parts = []
    for index, start in enumerate(at.point.starts):
        shown = problem.simulated(index, both, np.stack([start, start]))
        ramp = np.linspace(-0.5, 0.5, shown.shape[1])[:, None]
        change = problem.weighed(index, ((shown[1] - shown[0]) / one.step * ramp)[None])[0]
        parts.append(without(at.bases[index], change))
    change = np.concatenate(parts)
    slopes, left = at.slopes[: len(change)], at.left[: len(change)]
    change = change - slopes @ (at.covariance @ (slopes.T @ change))
    square, right = float(change @ change), float(change @ left)
    if square <= 0.0:
        return 0.0, 0.0
    return _growth(0.5 * right**2 / square, 0.5 * float(at.left @ at.left)), right / square


def _growth(drop: float, whole: float) -> float:
    """Of log L where a drop of the weighed squares lets the discrepancy shrink along with them."""
    return -whole * math.log(max(1.0 - drop / max(whole, 1e-300), 1e-12))


def held_against_drift(problem: Problem, point: Point) -> EffectUse | None:
    """The drag with which a hypothesis without any loss leaves least; None where there is no need of one."""
    hypothesis = point.hypothesis
    uses = (*hypothesis.base.effects, *hypothesis.terms)
    if hypothesis.numbers.get("viscous_drag") or any(is_loss(use) for use in uses):
        return None
    if not any(one.lowest_hz > 0.0 for one in problem.series):
        return None
    tried = [
        EffectUse(id_, {"coefficient_nms_rad": float(hypothesis.numbers[inertia] / time_s)})
        for id_, inertia in _DRAGS.items()
        if inertia in hypothesis.numbers and may_join(EFFECTS[id_], hypothesis)
        for time_s in _TIMES_S
    ]
    left = _left(problem, point, [hypothesis, *(hypothesis.with_term(use) for use in tried)])
    best = int(np.argmin(left))
    return tried[best - 1] if left[best] < HALF * left[0] else None


def _left(problem: Problem, point: Point, hypotheses: Sequence[Hypothesis]) -> Array:
    """Squares of errors of each hypothesis over those of the signals, at all frequencies."""
    packed = [one.packed() for one in hypotheses]

    def of(index: int) -> Array:
        one = problem.series[index]
        starts = np.repeat(point.starts[index][None], len(packed), axis=0)
        shown = problem.simulated(index, packed, starts, keep=False)
        away = (one.measured - shown)[:, :, one.has] / np.sqrt(problem.signal[one.has])
        return np.asarray(np.sum(away**2, axis=(1, 2)))

    return np.asarray(sum(problem.each(of)))
