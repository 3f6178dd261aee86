"""The verdict: three lines, every term of which the data set.

- `named`: an effect whose confidence is one half or more: the posterior weight of the hypotheses that hold
  it, times the share of the misfit beyond noise that goes with it, recordings held out included.
- `none`: numbers alone have half of the weight or more, and what they leave is proven noise.
- `unknown`: anything else.

The share is what keeps a name modest where something without a name is larger: a discrepancy that stays can
make up a name that takes off less than itself.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from hil.analysis.missing_effects._constancy import constancy
from hil.analysis.missing_effects._curve import curves_of
from hil.analysis.missing_effects._fit import Linearised, Point, fit, linearised, point_at
from hil.analysis.missing_effects._hypothesis import TOLERANCE, Hypothesis
from hil.analysis.missing_effects._noise import rounding_step
from hil.analysis.missing_effects._odds import ALIKE, Candidate, remains, weights_of
from hil.analysis.missing_effects._orders import PERIODS, turns
from hil.analysis.missing_effects._outcome import Gap, Named, Outcome, Replay, Verdict
from hil.analysis.missing_effects._problem import Problem
from hil.analysis.missing_effects._screen import NUMBERS
from hil.analysis.missing_effects._search import HALF, Search, is_loss
from hil.analysis.missing_effects._spectrum import RIGHT_TO
from hil.core.channels import OUTPUTS
from hil.core.effects import EFFECTS
from hil.core.model import EffectUse, Model

Array = npt.NDArray[np.float64]

_LATE = {"actuator_lag": ("sensor_lag", "time_constant_s"), "dead_time": ("channel_skew", "delay_s")}
_RIVALS = 3  # names that may take the place of another
_SHOWN = 5  # alternatives
_DRAWN = 40  # models, by which a figure of the new model is known


@dataclass(frozen=True)
class Judged:
    """A search, and what a candidate leaves: variance over all data, gaps of both kinds of data.

    `asked` is the model as it came.
    """

    asked: Model
    done: Search
    left: Callable[[Candidate], Array]
    gaps: Callable[[Candidate], tuple[dict[str, Gap], dict[str, Gap]]]
    fitted: tuple[Replay, ...]
    held_out: tuple[Replay, ...]


def judged(of: Judged, notes: tuple[str, ...], seconds: float) -> Outcome:
    """The outcome of a search."""
    done = of.done
    as_the_base = _as_the_base(done, done.best)
    best, shares = _worth_telling(of, done.best)
    _swapped(done, best)
    candidates = list(done.found.values())
    weights = weights_of(candidates, done.values)
    at = linearised(done.weighed_as(best), best.point)
    rivals = _alike(done, best, candidates)
    effects: list[Named] = []
    doubtful: list[Named] = []
    for index, use in enumerate(best.point.hypothesis.terms):
        named = _named(best, index, use, at, candidates, weights, rivals, shares[index])
        (effects if named.confidence >= HALF else doubtful).append(named)
    numbers = _numbers(at, of.asked)
    far = _is_far(numbers, done)
    if not far and done.problem.is_noise(best.point.errors):  # what has no name bends numbers as well
        effects += _mismatches(done, numbers, best, as_the_base)
    if done.problem.is_noise(best.point.errors):
        effects += _roundings(done, float(weights[candidates.index(best)]))
    something_else = _remains(of, done.found[()], best) if best.names else 0.0
    verdict: Verdict = "unknown"
    if effects:
        verdict = "named"
    elif not best.names and done.problem.is_noise(best.point.errors):
        verdict = "none"
    others = _others(of, best, candidates, weights)
    return Outcome(
        verdict, tuple(effects), tuple([*doubtful, *others][:_SHOWN]), something_else, numbers, far,
        *of.gaps(best), best.point.hypothesis.model(),
        curves_of(best.point.hypothesis, done.problem.series), notes, seconds,
        done.problem.noise * np.sqrt(done.problem.series[0].block), at.drawn(_DRAWN), of.fitted, of.held_out,
    )  # fmt: skip


def _as_the_base(done: Search, best: Candidate) -> frozenset[str]:
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
        begins = [_with_number(one.point.hypothesis, name, base) for one in (best, *alike)]
        fewer = [
            begins[0].closed(index, optional)
            for index, opened in enumerate(hypothesis.opened)
            for optional in sorted(opened)
        ]
        ended = [done.fitted(one, best, held=frozenset({name})) for one in (*begins, *fewer)]
        if max(done.score(one) for one in ended) > done.score(best) - ALIKE:
            found.append(name)
    return frozenset(found)


def _with_number(hypothesis: Hypothesis, name: str, value: float) -> Hypothesis:
    return replace(hypothesis, numbers={**hypothesis.numbers, name: value})


def _worth_telling(of: Judged, best: Candidate) -> tuple[Candidate, list[float]]:
    """Without effects that take off less than half of what stays without them; shares of the others."""
    while best.names:
        at = linearised(of.done.weighed_as(best), best.point)
        shares = [
            (1.0 - _remains(of, _without(of.done, best, index), best))
            * constancy(of.done.problem, at, index, of.done.cost_of_a_number(best))
            if _is_line(of.done, at, index)
            else 0.0
            for index in range(len(best.names))
        ]
        least = int(np.argmin(shares))
        if shares[least] >= HALF:
            return best, shares
        best = _without(of.done, best, least)
    return best, []


def _is_line(done: Search, at: Linearised, index: int) -> bool:
    """Whether an effect follows no angle, or recordings hold periods of its order and tell it to half a one.

    A ripple of less than that takes up whatever is slow.
    """
    use = at.point.hypothesis.terms[index]
    side = EFFECTS[use.id].law.follows
    if side is None:
        return True
    whole = turns(done.problem, side)
    sure = at.standard_error(index, "order") * whole < HALF
    return sure and float(use.values["order"]) * whole >= PERIODS


def _swapped(done: Search, best: Candidate) -> None:
    """Far from noise, fit the best hypothesis with each name in turn replaced by others.

    A forward search finds a name beside those before it; names that could stand in its place must be given
    the chance, or the data would seem to tell them apart. Near noise those go on that were left behind while
    their numbers promised as much as the best one has.
    """
    if done.problem.is_noise(best.point.errors):
        least = done.score(best) - ALIKE
        for one in list(done.found.values()):
            behind = len(one.names) == len(best.names) and done.score(one) < least
            if behind and least < done.score(one) + done.promised(one):
                done.fitted(one.point.hypothesis, one)
        return
    pool = sorted(done.found.values(), key=done.score, reverse=True)
    uses = {label: one for one in pool for label in one.names}
    for index in range(len(best.names)):
        rivals = [label for label in uses if label not in best.names][:_RIVALS]
        fewer = best.point.hypothesis.without(index)
        for label in rivals:
            other = uses[label].point.hypothesis
            at = other.names.index(label)
            done.fitted(fewer.with_term(other.terms[at], other.opened[at]), best)


def _without(done: Search, best: Candidate, index: int) -> Candidate:
    key = tuple(sorted(name for at, name in enumerate(best.names) if at != index))
    return done.found.get(key) or done.fitted(best.point.hypothesis.without(index), best)


def _named(
    best: Candidate,
    index: int,
    use: EffectUse,
    at: Linearised,
    candidates: Sequence[Candidate],
    weights: Array,
    rivals: Mapping[str, tuple[str, ...]],
    share: float,
) -> Named:
    label = best.names[index]
    alike = rivals.get(label, ())
    held = sum(float(w) for one, w in zip(candidates, weights, strict=True) if {label, *alike} & {*one.names})
    errors = {
        name: at.standard_error(index, name)
        for name in use.values
        if np.isfinite(at.standard_error(index, name))
    }
    names = [part for name in (label, *alike) for part in name.split(" + ")]
    test = "; or ".join(dict.fromkeys(EFFECTS[name.split("(")[0]].shown_by for name in names))
    return Named(use, held * share, errors, alike, test if alike else "")


def _remains(of: Judged, before: Candidate, after: Candidate) -> float:
    """Share of the variance beyond noise that stays; none where numbers of the base had explained it.

    Nor where all that stays may be slow noise, if of one channel half as much as that was taken off, and by
    more than fits to noise so slow bring.
    """
    problem, done = of.done.problem, of.done
    if after.prior - before.prior > done.cost_of_a_number(after) and done.score(after) > done.score(before):
        return 0.0
    had, has = of.left(before), of.left(after)
    there, noise = np.isfinite(has), problem.noise**2
    if np.all(has[there] <= problem.slow_noise * noise[there]):
        grew = after.log_likelihood - before.log_likelihood
        cost = grew - (done.score(after) - done.score(before))
        off, slow = (had - has)[there], np.maximum(has - noise, 0.0)[there]
        if grew / problem.slow_noise > cost and np.any(off > HALF * slow):
            return 0.0
    return remains(had, has, problem.noise**2, problem.slow_noise)


def _roundings(done: Search, weight: float) -> list[Named]:
    """Channels whose noise is the distance of their readings, where nothing else is missing."""
    known = {
        use.values.get("channel") for use in done.problem.model.effects if use.id == "sensor_quantization"
    }
    found = []
    for column, name in enumerate(OUTPUTS):
        have = [one.samples[:, column] for one in done.problem.series if one.has[column]]
        step = rounding_step(np.concatenate(have)) if have and name not in known else 0.0
        if step > 0.0 and step / np.sqrt(12.0) >= done.problem.noise[column]:
            use = EffectUse("sensor_quantization", {"channel": name, "step": step})
            found.append(Named(use, weight, {}))
    return found


def _alike(done: Search, best: Candidate, candidates: Sequence[Candidate]) -> dict[str, tuple[str, ...]]:
    """Of each name of the best hypothesis: the names that could take its place without the data telling."""
    problem = done.weighed_as(best)
    found: dict[str, tuple[str, ...]] = {}
    for one in candidates:
        lost, new = {*best.names} - {*one.names}, {*one.names} - {*best.names}
        if len(lost) != 1 or len(new) != 1 or done.score(best) - done.score(one) > ALIKE:
            continue
        if _apart(problem, best.point, one.point) < ALIKE:
            name = lost.pop()
            found[name] = (*found.get(name, ()), new.pop())
    for index, use in enumerate(best.point.hypothesis.terms):
        late = _late_outputs(done, best.point.hypothesis.without(index), use)
        if late is None:
            continue
        laws = [EFFECTS[other.id].law for other in best.point.hypothesis.without(index).terms]
        linear = all(law.chain is not None or law.reads is not None for law in laws)
        other = best.point if linear else fit(problem, point_at(problem, late, best.point.starts))
        if _apart(problem, best.point, other) < ALIKE:
            label = best.names[index]
            names = [name for name in late.names if name not in best.names]
            found[label] = (*found.get(label, ()), " + ".join(names))
    return found


def _apart(problem: Problem, one: Point, other: Point) -> float:
    """Log odds by which the data would tell the predictions of two points apart."""
    pairs = enumerate(zip(one.errors, other.errors, strict=True))
    return sum(
        0.5 * float(np.sum(problem.weighed(index, np.nan_to_num(a - b)[None]) ** 2))
        for index, (a, b) in pairs
    )


def _late_outputs(done: Search, rest: Hypothesis, use: EffectUse) -> Hypothesis | None:
    """All outputs late alike in place of a late torque: in a linear axle the two are one."""
    if use.id not in _LATE:
        return None
    has = np.any([one.has for one in done.problem.series], axis=0)
    sensor, number = _LATE[use.id]
    for channel in (name for name, there in zip(OUTPUTS, has, strict=True) if there):
        late = float(use.values[EFFECTS[use.id].parameters[0].name])
        rest = rest.with_term(EffectUse(sensor, {"channel": channel, number: late}))
    return rest


def _others(of: Judged, best: Candidate, candidates: Sequence[Candidate], weights: Array) -> list[Named]:
    """Names that stand in place of one of the best hypothesis, by the weight of such hypotheses.

    Where that has no name, times the share of the misfit that goes with them, as of a name that is given.
    """
    held: dict[str, tuple[float, EffectUse, Candidate]] = {}
    for one, weight in zip(candidates, weights, strict=True):
        if best.names and {*best.names} <= {*one.names}:
            continue
        for label, use in zip(one.names, one.point.hypothesis.terms, strict=True):
            if label not in best.names:
                had, _, likelier = held.get(label, (0.0, use, one))
                held[label] = (had + float(weight), use, max(likelier, one, key=lambda c: c.log_likelihood))
    ranked = sorted(held.values(), key=lambda pair: -pair[0])
    found = []
    for weight, use, one in ranked[:_SHOWN]:
        share = 1.0 if best.names else 1.0 - _remains(of, best, one)
        if weight * share > 0.0:
            model = one.point.hypothesis.model()
            found.append(Named(use, weight * share, {}, (), EFFECTS[use.id].shown_by, model))
    return sorted(found, key=lambda one: -one.confidence)


def _numbers(at: Linearised, asked: Model) -> dict[str, tuple[float, float, float]]:
    """Numbers of the base: as it came, as found, standard error."""
    return {
        name: (float(asked.parameters[name]), float(value), at.standard_error(-1, name))
        for name, value in at.point.hypothesis.numbers.items()
    }


def _off(name: str, numbers: Mapping[str, tuple[float, float, float]], done: Search) -> tuple[float, float]:
    """How far a number moved and how sure that is, both in tolerances."""
    base, found, error = numbers[name]
    tolerance = _tolerance(name, base, done)
    return abs(found - base) / tolerance, error / tolerance


def _tolerance(name: str, base: float, done: Search) -> float:
    """Of a number of the base, in its unit."""
    size = abs(base) or done.problem.scales[name]  # only numbers that have a scale may be zero
    return float(done.problem.model.tolerance.get(name, TOLERANCE) * size)


def _is_far(numbers: Mapping[str, tuple[float, float, float]], done: Search) -> bool:
    """Whether most of the numbers that the data fix are not what the base says.

    The prior alone leaves 0.7 of a tolerance.
    """
    known = [_off(name, numbers, done) for name in numbers]
    fixed = [moved for moved, error in known if error < HALF]
    return len(fixed) > 1 and sum(moved > 1.0 for moved in fixed) > HALF * len(fixed)


def _mismatches(
    done: Search,
    numbers: Mapping[str, tuple[float, float, float]],
    best: Candidate,
    as_the_base: frozenset[str],
) -> list[Named]:
    """Numbers that are wrong by more than their tolerance and doubt, each with the probability of that.

    Beside an effect, which bends numbers as well, those that are effects by themselves: a dead time, a drag.
    One that moves no channel by more than what no model is right to says nothing.
    """
    from scipy.special import ndtr

    found = []
    for name, (_, value, error) in numbers.items():
        if best.names and (name in as_the_base or not _stands_beside(name, best, done.problem.model)):
            continue
        moved, doubt = _off(name, numbers, done)
        sure = float(ndtr((moved - 1.0) / max(doubt, 1e-12)))
        if sure >= HALF and moved - 1.0 > doubt and _shows(done.problem, best.point, name):
            found.append(
                Named(
                    EffectUse("parameter_mismatch", {"parameter": name, "value": value}),
                    sure,
                    {"value": error},
                )
            )
    return found


def _stands_beside(name: str, best: Candidate, base: Model) -> bool:
    """Whether a number that moved is an effect of its own beside others: a dead time, a drag.

    A drag beside another loss is one where the base has none: what a friction's law gets wrong bends it.
    """
    loses = any(is_loss(use) for use in best.point.hypothesis.terms)
    bent = name == NUMBERS["viscous_drag"] and loses and base.parameters[name] > 0.0
    return name in NUMBERS.values() and not bent


def _shows(problem: Problem, point: Point, name: str) -> bool:
    """Whether a number of the base put back moves a channel by more than what no model is right to."""
    base = problem.model.parameters[name]
    back = point_at(problem, _with_number(point.hypothesis, name, base), point.starts)
    pairs = zip(back.errors, point.errors, strict=True)
    moved = problem.mean_square([one - other for one, other in pairs])
    return bool(np.nanmax(moved / np.maximum(problem.signal, 1e-300)) > RIGHT_TO**2)
