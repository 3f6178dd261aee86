"""The verdict: three lines, every term of which the data set.

- `named`: an effect whose confidence is one half or more: the posterior weight of the hypotheses that hold
  it, times the share of the misfit beyond noise that goes with it, recordings held out included.
- `none`: numbers alone have half of the weight or more, and what they leave is proven noise.
- `unknown`: anything else.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from hil.analysis.missing_effects._candidates import Candidates
from hil.analysis.missing_effects._curve import curves_of
from hil.analysis.missing_effects._fit import Linearised, Point, fit, linearised, point_at
from hil.analysis.missing_effects._hypothesis import Hypothesis, is_linear, is_loss, label_of
from hil.analysis.missing_effects._mismatch import as_known, is_far, mismatches, numbers_of
from hil.analysis.missing_effects._odds import ALIKE, Candidate, weights_of
from hil.analysis.missing_effects._outcome import Named, Outcome, Verdict
from hil.analysis.missing_effects._phase import errors_of
from hil.analysis.missing_effects._problem import Problem
from hil.analysis.missing_effects._rivals import (
    as_the_base_has,
    fit_in_place,
    fit_twins,
    gains_instead,
    without,
)
from hil.analysis.missing_effects._screen import NUMBERS, Scene
from hil.analysis.missing_effects._search import HALF
from hil.analysis.missing_effects._share import (
    LAW,
    Judged,
    held_against_drift,
    share_of,
    wrong_by_laws,
)
from hil.analysis.missing_effects._spectrum import RIGHT_TO
from hil.core.channels import OUTPUTS
from hil.core.effects import EFFECTS
from hil.core.model import EffectUse
from hil.plant import rounding_step

Array = npt.NDArray[np.float64]

_SECOND_SENSOR = (
    "No torque: in an axle that is linear both show the same. Read one of the channels by a second sensor, "
    "or on another path than the one that is late."
)
_LATE = {"actuator_lag": ("sensor_lag", "time_constant_s"), "dead_time": ("channel_skew", "delay_s")}
_LED = 6  # candidates, whose odds are looked at where speeds lead
_SHOWN = 5  # alternatives
_DRAWN = 40  # models, by which a figure of the new model is known


def as_far_as_known(of: Judged, why: str) -> Outcome:
    """The outcome of a search that was not through: names are candidates, the model has none of them."""
    done = of.done
    alone, candidates = done.found.get((), done.best), list(done.found.values())
    at = linearised(done.weighed_as(alone, once=True), alone.point)
    values = done.problem.powers(alone.point.errors, once=True).values(done.problem.noise)
    weights = _weights(done.problem, candidates, values)[None]
    numbers, model = numbers_of(at, of.asked), alone.point.hypothesis.model()
    return Outcome(
        "unknown", (), tuple(_others(of, alone, candidates, weights)), as_known(done.problem, numbers),
        is_far(numbers, done), model, model,
        curves_of(alone.point.hypothesis, of.fitted), 0.0,
        done.problem.noise * np.sqrt(done.problem.samples_in_a_mean), (), of.fitted, of.held_out,
        unfinished=why,
    )  # fmt: skip


def judged(of: Judged) -> Outcome:
    """The outcome of a search."""
    done = of.done
    likeliest = done.best
    at = linearised(done.weighed_as(likeliest, once=True), likeliest.point)
    if done.problem.is_noise(likeliest.point.errors):
        far = is_far(numbers_of(at, of.asked), done)
        fit_twins(done, likeliest, done.score(likeliest) - ALIKE, far=far)
    elif len(likeliest.names) > 1:
        fit_in_place(done, likeliest, is_loss)
    if done.best is not likeliest:
        at = linearised(done.weighed_as(done.best, once=True), done.best.point)
    may_be_off = _may_be_off(of, at)
    as_the_base = as_the_base_has(done, done.best) if may_be_off else frozenset[str]()
    gains = gains_instead(done, done.best) if may_be_off else {}
    best, at, shares = _worth_telling(of, done.best)
    fit_in_place(done, best)
    likelier = max((one for one in done.found.values() if len(one.names) == len(best.names)), key=done.score)
    near_noise = done.problem.is_noise(best.point.errors)
    if near_noise and done.score(likelier) > done.score(best):
        best, at, shares = _worth_telling(of, likelier)
    if is_far(numbers_of(at, of.asked), done):
        best, at = _from_far(done, best)
    candidates = list(done.found.values())
    if near_noise and best.names:  # more names than are worth telling decide nothing
        candidates = [one for one in candidates if len(one.names) <= len(best.names)]
    values = done.problem.powers(best.point.errors, once=True).values(done.problem.noise)
    numbers = numbers_of(at, of.asked)
    weights = _weights(done.problem, candidates, values)[None]
    if best.names and not near_noise and best.point.hypothesis.kind != "rigid":
        candidates, weights = _also_where_led(done, candidates, weights, best)
    rivals = _alike(done, best, candidates, weights)
    effects: list[Named] = []
    doubtful: list[Named] = []
    for index in range(len(best.names)):
        errors = _errors(done.problem, at, index)
        named = _named(best, index, errors, candidates, weights, rivals, shares[index])
        (effects if named.confidence >= HALF else doubtful).append(named)
    if _may_be_off(of, at):
        effects += mismatches(
            done, numbers, best, as_the_base, gains, [*zip(candidates, weights[0], strict=True)]
        )
    if done.problem.is_noise(best.point.errors):
        effects += _roundings(done, float(weights[0, candidates.index(best)]))
    verdict: Verdict = "unknown"
    if effects:
        verdict = "named"
    elif not best.names and done.problem.is_noise(best.point.errors):
        verdict = "none"
    others = _others(of, best, candidates, weights)
    given, steadied = best.point.hypothesis, held_against_drift(done.problem, best.point)
    model = (given.with_term(steadied) if steadied else given).model()
    return Outcome(
        verdict, tuple(effects), tuple([*doubtful, *others][:_SHOWN]), as_known(done.problem, numbers),
        done.problem.far, model, done.found[()].point.hypothesis.model(),
        curves_of(best.point.hypothesis, of.fitted), 0.0,
        done.problem.noise * np.sqrt(done.problem.samples_in_a_mean), at.drawn(_DRAWN),
        of.fitted, of.held_out, steadied,
    )  # fmt: skip


def _from_far(done: Candidates, best: Candidate) -> tuple[Candidate, Linearised]:
    """Fitted without the base's word on its numbers, but for teeth: it is far off as a whole.

    One of them that the data leave free would hold those that follow from it, a gain or a count of teeth.
    """
    done.problem = replace(done.problem, far=True)
    settled = done.judged(fit(done.weighed_as(best), best.point))
    best = max(done.judged(best.point), settled, key=done.score)
    done.found[tuple(sorted(best.names))] = best
    return best, linearised(done.weighed_as(best, once=True), best.point)


def _weights(problem: Problem, candidates: Sequence[Candidate], values: float) -> Array:
    """Posterior weight of each candidate; what a repeated torque shows again and again counts once.

    A fit may use every window of it, as a composite likelihood; odds may not (C. Varin, N. Reid, D. Firth,
    Statistica Sinica 21 (2011) 5). Nor may a base decide whose numbers are far off.
    """
    if problem.far:
        candidates = [replace(one, prior=problem.log_prior(one.point.hypothesis)) for one in candidates]
    once = (problem.powers(one.point.errors, once=True) for one in candidates)
    windows = np.stack([one.log_likelihood(problem.noise) for one in once])
    return weights_of(candidates, windows, values)


def _also_where_led(
    done: Candidates, candidates: Sequence[Candidate], weights: Array, best: Candidate
) -> tuple[list[Candidate], Array]:
    """The likeliest candidates, with their weights and with those that they have where recorded speeds lead.

    Far from noise numbers make up for a law that is wrong as long as motion goes its own way.
    """
    leading = Candidates(done.led_problem)
    ranked = np.argsort(-weights[0])[:_LED].tolist()
    places = [*{*ranked, candidates.index(best)}]
    some = [candidates[place] for place in places]
    led = [leading.judged(done.led(one.point)) for one in some]
    values = leading.problem.powers(led[some.index(best)].point.errors, once=True).values(done.problem.noise)
    return some, np.stack([weights[0, places], _weights(leading.problem, led, values)])


def _may_be_off(of: Judged, at: Linearised) -> bool:
    """Whether single numbers of the base may be wrong: what has no name bends them, a far base has none."""
    far = of.done.problem.far or is_far(numbers_of(at, of.asked), of.done)
    return of.done.problem.is_noise(at.point.errors) and not far


def _worth_telling(of: Judged, best: Candidate) -> tuple[Candidate, Linearised, list[float]]:
    """Without effects that take off less than half of what stays without them; shares of the others."""
    while True:
        at = linearised(of.done.weighed_as(best, once=True), best.point)
        if not best.names:
            return best, at, []
        fewer = [without(of.done, best, index) for index in range(len(best.names))]
        shares = [
            share_of(of, one, best, at, index, wrong_by_laws(of, best, fewer, index))
            for index, one in enumerate(fewer)
        ]
        least = int(np.argmin(shares))
        if shares[least] >= HALF:
            return best, at, shares
        best = without(of.done, best, least)


def _named(
    best: Candidate,
    index: int,
    errors: dict[str, float],
    candidates: Sequence[Candidate],
    weights: Array,
    rivals: Mapping[str, tuple[str, ...]],
    share: float,
) -> Named:
    label = best.names[index]
    alike = rivals.get(label, ())
    held = _held({label, *alike}, candidates, weights)
    single = [name.split("(")[0] for name in (label, *alike) if " + " not in name]
    tests = [EFFECTS[name].shown_by for name in single] if len(single) > 1 else []
    if any(" + " in name for name in alike):
        tests.append(_SECOND_SENSOR)
    test = " Or: ".join(dict.fromkeys(tests))
    return Named(best.point.hypothesis.terms[index], held * share, errors, alike, test if alike else "")


def _errors(problem: Problem, at: Linearised, index: int) -> dict[str, float]:
    """Standard errors of an effect's numbers: by the fit, its law, and angles that may have walked off."""
    use = at.point.hypothesis.terms[index]
    law = RIGHT_TO if is_linear(use) else LAW  # nor are numbers known better, but an order, which is counted
    errors = {
        name: float(np.hypot(error, (0.0 if name == "order" else law) * float(value)))
        for name, value in use.values.items()
        if np.isfinite(error := at.standard_error(index, name))
    }
    if EFFECTS[use.id].law.follows:
        walked = errors_of(problem, at.point, use)
        errors |= {name: max(errors[name], walked[name]) for name in walked if name in errors}
    return errors


def _roundings(done: Candidates, weight: float) -> list[Named]:
    """Channels whose noise is the distance of their readings, where nothing else is missing."""
    known = {
        use.values.get("channel") for use in done.problem.model.effects if use.id == "sensor_quantization"
    }
    found, series = [], done.problem.series
    for column, name in enumerate(OUTPUTS):
        have = [one.samples[:, column] for one in series if one.has[column] and not one.of_angle[column]]
        step = rounding_step(np.concatenate(have)) if have and name not in known else 0.0
        if step > 0.0 and step / np.sqrt(12.0) >= done.problem.noise[column]:
            use = EffectUse("sensor_quantization", {"channel": name, "step": step})
            found.append(Named(use, weight, {}))
    return found


def _alike(
    done: Candidates, best: Candidate, candidates: Sequence[Candidate], weights: Array
) -> dict[str, tuple[str, ...]]:
    """Of each name of the best hypothesis: the names that could take its place without the data telling.

    They tell two names apart where one is in the place of the other at odds of 20 : 1. Of more names than are
    given each would stand in the place of another that it goes with; nor does one that stands beside them in
    the likeliest hypothesis, and was dropped.
    """
    problem = done.weighed_as(best, once=True)
    weights = weights * np.array([len(one.names) <= len(best.names) for one in candidates])
    beside = {*max(candidates, key=done.score).names}
    beside = beside if {*best.names} <= beside else {*best.names}
    others = sorted({name for one in candidates for name in one.names} - beside)
    found: dict[str, tuple[str, ...]] = {}
    for name in best.names:
        least = np.exp(-ALIKE) * _held({name}, candidates, weights)
        alike = tuple(one for one in others if _held({one}, candidates, weights, but=name) > least)
        if alike:
            found[name] = alike
    for index, use in enumerate(best.point.hypothesis.terms):
        late, names = _late_elsewhere(done, best.point.hypothesis.without(index), use)
        if not names:
            continue
        linear = all(is_linear(other) for other in best.point.hypothesis.without(index).terms)
        other = best.point if linear else fit(problem, point_at(problem, late, best.point.starts))
        if _apart(problem, best.point, other) < ALIKE:
            label = best.names[index]
            found[label] = (*found.get(label, ()), " + ".join(names))
    return found


def _held(names: Set[str], candidates: Sequence[Candidate], weights: Array, but: str = "") -> float:
    """Weight of all candidates that have one of names, `but` those that have that one.

    Args:
        weights: kinds x candidates; the least kind counts.
    """
    has = [but not in one.names and not names.isdisjoint(one.names) for one in candidates]
    return float(np.min(np.sum(weights[:, has], axis=1)))


def _apart(problem: Problem, one: Point, other: Point) -> float:
    """Log odds by which the data would tell the predictions of two points apart."""
    pairs = enumerate(zip(one.errors, other.errors, strict=True))
    return sum(
        0.5 * float(np.sum(problem.weighed(index, np.nan_to_num(a - b)[None]) ** 2))
        for index, (a, b) in pairs
    )


def _late_elsewhere(done: Candidates, rest: Hypothesis, use: EffectUse) -> tuple[Hypothesis, list[str]]:
    """All outputs late alike in place of a late torque, or that in place of the only output; its names.

    In a linear axle the two are one.
    """
    channels = Scene(done.problem, rest).channels
    for torque, (sensor, number) in _LATE.items():
        first = EFFECTS[torque].parameters[0].name
        if use.id == torque:
            late = float(use.values[first])
            uses = [EffectUse(sensor, {"channel": one, number: late}) for one in channels]
            for one in uses:
                rest = rest.with_term(one)
            return rest, [label_of(one) for one in uses]
        if use.id == sensor and len(channels) == 1:
            late, moved = float(use.values[number]), NUMBERS.get(torque, "")
            if moved in rest.numbers:
                return rest.with_number(moved, rest.numbers[moved] + late), [torque]
            return rest.with_term(EffectUse(torque, {first: late})), [torque]
    return rest, []


def _others(of: Judged, best: Candidate, candidates: Sequence[Candidate], weights: Array) -> list[Named]:
    """Names that stand in place of one of the best hypothesis, by the weight of such hypotheses.

    Where that has no name, times the share of the misfit that goes with each, as of a name that is given.
    """
    held: dict[str, tuple[Array, EffectUse, Candidate]] = {}
    for one, weight in zip(candidates, weights.T, strict=True):
        if best.names and {*best.names} <= {*one.names}:
            continue
        for label, use in zip(one.names, one.point.hypothesis.terms, strict=True):
            if label not in best.names:
                had, _, likelier = held.get(label, (np.zeros(len(weights)), use, one))
                held[label] = (had + weight, use, max(likelier, one, key=lambda c: c.log_likelihood))
    ranked = sorted(held.values(), key=lambda one: -float(np.min(one[0])))
    found = []
    for kinds, use, one in ranked[:_SHOWN]:
        weight, share = float(np.min(kinds)), 1.0
        if not best.names:
            at = linearised(of.done.weighed_as(one, once=True), one.point)
            index = one.names.index(label_of(use))
            fewer = of.done.found.get(tuple(sorted({*one.names} - {label_of(use)})), best)
            share = share_of(of, fewer, one, at, index)
        if weight * share > 0.0:
            model = one.point.hypothesis.model()
            found.append(Named(use, weight * share, {}, (), EFFECTS[use.id].shown_by, model))
    return sorted(found, key=lambda one: -one.confidence)
