"""The one search: numbers alone, then the best name joins and needless ones leave, while the score grows."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from hil.analysis.missing_effects._balance import read_numbers, readings
from hil.analysis.missing_effects._candidates import GROWING, LOOK, MOST_ROUNDS, Candidates
from hil.analysis.missing_effects._fit import (
    Linearised,
    linearised,
    point_at,
    with_better_starts,
)
from hil.analysis.missing_effects._hypothesis import Hypothesis, bends, is_loss
from hil.analysis.missing_effects._linear import numbers_alone, responses_of, with_linear_effects
from hil.analysis.missing_effects._odds import ALIKE, Candidate, remains
from hil.analysis.missing_effects._phase import errors_of
from hil.analysis.missing_effects._problem import Problem
from hil.analysis.missing_effects._screen import (
    Scene,
    best_by_name,
    promised_by,
    promises,
)
from hil.core.effects import EFFECTS, Parameter
from hil.core.model import EffectUse

HALF = 0.5  # of what stays without it a name must take off
_TRIED = 8  # hypotheses that a step begins with, the most promising ones; half of them go on each time
_BESIDE = 0.3  # of an effect's first number: where an optional one in the same unit begins
_MOST_NAMES = 4
_NEAR_WHOLE, _SURE = 0.05, 3.0  # of an order; standard errors


def search(done: Candidates, show: Callable[[str], None]) -> None:
    """Fit the numbers alone, then grow and prune sets of effects until noise is left or none pays.

    Where noise is left but the base's numbers had to move, an effect may be the likelier.

    Args:
        done: nothing yet; holds what was fitted, also after an exception.
    """
    show("fitting the numbers alone")
    problem = done.problem
    start, linear = _start(problem)
    started = with_better_starts(problem, point_at(problem, start))
    done.problem = problem.weighed_as(started.errors)
    best = done.fitted(start, None)
    best = _with_better_angles(done, done.fitted(best.point.hypothesis, best))
    weak = False
    while len(best.names) < _MOST_NAMES and (done.may_gain(best) or done.may_give_way(best)):
        grown = _grown(done, best, () if best.names else linear(), show)
        if grown is None or not done.gains(best, grown):
            break
        had, has = (problem.mean_square(one.point.errors) for one in (best, grown))
        was_weak, weak = weak, remains(had, has, *problem.noise_in(grown.point.errors)) > HALF
        if weak and (was_weak or best.point.hypothesis.is_abrupt):
            break  # of two that go together the first may take off less than half, the second does not
        best = _with_whole_orders(done, _with_better_angles(done, _pruned(done, grown, show)))


def _with_better_angles(done: Candidates, best: Candidate) -> Candidate:
    """Go on; fit a ripple to angles as they are better known after it, while its likelihood grows."""
    for _ in range(MOST_ROUNDS):
        angles = done.problem.angles
        begins = done.go_on_from(best)
        if begins is best:
            return best
        had, fitted = best.log_likelihood, done.fitted(begins.point.hypothesis, begins)
        if fitted.log_likelihood < had - ALIKE:  # what else is missing has spoiled them
            done.problem = replace(done.problem, angles=angles)
            return best
        best = fitted
        if best.log_likelihood < had + GROWING:
            break
    return best


def _with_whole_orders(done: Candidates, best: Candidate) -> Candidate:
    """The likelier of a hypothesis and of its ripples fitted again from whole numbers of periods a turn.

    Most ripples have one. Where angles walk off, a fit may end beside it, with errors that do not hold it.
    """
    hypothesis, kept = best.point.hypothesis, (done.problem, done.values)
    for index, use in enumerate(hypothesis.terms):
        order = float(use.values.get("order", 0.0))
        off = abs(order - round(order))
        if (
            order > 0.5
            and 0.0 < off < _NEAR_WHOLE
            and off > _SURE * errors_of(done.problem, best.point, use)["order"]
        ):
            whole = {"order": float(round(order))}
            hypothesis = hypothesis.with_values(index, whole, hypothesis.opened[index])
    if hypothesis is best.point.hypothesis:
        return best
    tried = _with_better_angles(done, done.at(hypothesis, best))
    if tried.log_likelihood > best.log_likelihood:
        return tried
    done.problem, done.values = kept
    return best


def _start(problem: Problem) -> tuple[Hypothesis, Callable[[], list[tuple[Hypothesis, float]]]]:
    """Numbers alone by the data; linear effects that responses show behind them, once these are asked for.

    Of a chain with shafts the base's own numbers stay where they are the likelier.
    """
    base = problem.as_it_came
    read = None if problem.functions else read_numbers(problem.model, problem.series)
    responses = None if problem.functions or read is not None else responses_of(problem)
    if responses is None:
        return read or base, list
    alone = numbers_alone(responses)

    def likelihood(one: Hypothesis) -> float:
        point = with_better_starts(problem, point_at(problem, one))
        return float(np.sum(point.powers(problem).log_likelihood(problem.noise)))

    start = max((alone, base), key=likelihood)
    return start, partial(with_linear_effects, responses, alone)


def _grown(
    done: Candidates, best: Candidate, linear: Sequence[tuple[Hypothesis, float]], show: Callable[[str], None]
) -> Candidate | None:
    """The best hypothesis with one more effect; None where no effect promises more than it costs.

    `linear` are hypotheses that responses suggest, and what these bring.

    Losses (friction, drag, resistance), which every driveline has, are tried before rarer names: where one
    takes off half of what stays or more, only those are looked at that promise half of what it brought beside
    the numbers that are fitted: of what responses suggest that is not known.
    """
    suggested = sorted([*linear, *_suggested(done, best)], key=lambda one: -one[1])
    losses = [one for one in suggested if is_loss(one[0].terms[-1])]
    rarer = [one for one in suggested if not is_loss(one[0].terms[-1])]
    grown = _best_of(done, best, losses, show)
    if grown is not None and done.score(grown) > done.score(best):
        grown = _among_losses(done, grown, show)
        had, has = (done.problem.mean_square(one.point.errors) for one in (best, grown))
        if remains(had, has, done.problem.noise**2, done.problem.noise**2) <= HALF:
            brought = HALF * (grown.log_likelihood - best.log_likelihood)
            rarer = [one for one in rarer if brought < one[1] < math.inf and one not in linear]
    others = _best_of(done, best, rarer, show)
    return max((one for one in (grown, others) if one is not None), key=done.score, default=None)


def _among_losses(done: Candidates, grown: Candidate, show: Callable[[str], None]) -> Candidate:
    """The first loss, or each other one in its place or beside it, where that is likelier.

    One loss settles numbers from which another can be seen: dry friction, which may hold an axle, is found
    where a rolling resistance has it turn at the right speed. Dry and viscous losses go together.
    """
    if len(grown.names) > 1 or not done.may_gain(grown):
        return grown
    fewer = grown.point.hypothesis.without(0)
    near, problem = done.at(fewer, grown), done.weighed_as(grown)
    found = promises(problem, linearised(problem, near.point), is_loss)
    others = [one.use for one in best_by_name(found) if one.label not in grown.names]
    instead = _best_of(done, near, [(fewer.with_term(use), math.inf) for use in others], show, LOOK, grown)
    best = instead or grown
    if done.problem.is_noise(best.point.errors):
        return best  # what joins it is looked for by what it promises
    pairs: list[Candidate] = []
    for one in [one for one in done.found.values() if len(one.names) == 1 and one.names != best.names]:
        other, opened = one.point.hypothesis.terms[0], one.point.hypothesis.opened[0]
        if is_loss(other):
            show(f"fitting {' + '.join([*best.names, *one.names])}")
            pairs.append(done.fitted(best.point.hypothesis.with_term(other, opened), best, LOOK))
    ended = [done.fitted(one.point.hypothesis, one) for one in _best_of_each_name(done, pairs)[:1]]
    return max((best, *ended), key=done.score)


def _best_of(
    done: Candidates,
    best: Candidate,
    suggested: Sequence[tuple[Hypothesis, float]],
    show: Callable[[str], None],
    rounds: int = 1,
    grown: Candidate | None = None,
) -> Candidate | None:
    """The likeliest of suggested hypotheses, and of one that has been fitted.

    Each gets some rounds. Then those are fitted to their end, the most promising first, that come near the
    best so far by their score and what their numbers promise to add.
    """
    begun: list[Candidate] = []
    reached = 0.0
    most = max((gain for _, gain in suggested if gain < math.inf), default=0.0)
    for hypothesis, gain in suggested[:_TRIED]:
        if gain < HALF * min(most, reached):
            break  # others have more before them and more behind them
        show(f"fitting {' + '.join(hypothesis.names)}")
        begun.append(done.fitted(hypothesis, best, rounds))
        reached = max(reached, begun[-1].log_likelihood - best.log_likelihood)
    for may_reach, one in sorted(_most_promising(done, begun), key=lambda pair: -pair[0]):
        least = -math.inf if grown is None else done.score(grown) - ALIKE
        if may_reach > least:
            ended = _opened(done, done.fitted(one.point.hypothesis, one, at_least=least), show)
            grown = ended if grown is None else max(grown, ended, key=done.score)
    return grown


def _most_promising(done: Candidates, begun: Sequence[Candidate]) -> list[tuple[float, Candidate]]:
    """Of each set of names and laws the start that may reach most, with that score: starts are no rivals."""
    found: dict[object, tuple[float, Candidate]] = {}
    for one in begun:
        may_reach, key = done.may_reach(one), (one.names, one.point.hypothesis.laws)
        if key not in found or may_reach > found[key][0]:
            found[key] = may_reach, one
    return list(found.values())


def _best_of_each_name(done: Candidates, tried: Sequence[Candidate]) -> list[Candidate]:
    """The likeliest of each set of names, best first: starts of one name are no rivals."""
    found: dict[tuple[str, ...], Candidate] = {}
    for one in sorted(tried, key=done.score, reverse=True):
        found.setdefault(one.names, one)
    return list(found.values())


def _suggested(done: Candidates, best: Candidate) -> list[tuple[Hypothesis, float]]:
    """Hypotheses with one more effect, each with the growth of log L that it promises.

    Those that the latent torque names (which promises no number, so they are all tried, but where noise is
    left), and those that promise more than they cost.
    """
    is_noise = done.problem.is_noise(best.point.errors)
    read = [] if is_noise else readings(best.point.hypothesis, done.problem.series)
    by_name = {one.hypothesis.names: one.hypothesis for one in reversed(read)}
    order = dict.fromkeys(one.hypothesis.names for one in read)

    found = [
        (_likelier(done, best, one, best.point.hypothesis.with_term(one.terms[-1], one.opened[-1])), math.inf)
        for one in (by_name[names] for names in order)
    ]
    least = done.least(best)
    beside = _beside_the_base(done, best, least)
    gained = max((gain for _, gain in beside), default=0.0)
    most = done.problem.most_to_gain(best.point.errors)
    if not done.could_pay(best) or (beside and gained > HALF * most):
        return [*found, *beside]  # others promise less from where that is
    promised = promises(done.problem, linearised(done.problem, best.point))
    most = max((one.gain for one in promised), default=0.0)
    has_shafts = best.point.hypothesis.kind != "rigid"
    if has_shafts and done.is_astray(best) and most < HALF * done.problem.most_to_gain(best.point.errors):
        promised = [*promised, *promises(*done.where_led(best), bends)]
    for one in best_by_name([one for one in promised if one.gain > least]):
        starts = (base.with_term(one.use) for base in (best.point.hypothesis, one.numbers))
        found.append((_likelier(done, best, *starts), one.gain))
        elsewhere = _as_elsewhere(done, best, one.label)
        if elsewhere:
            found.append((_likelier(done, best, *elsewhere), one.gain))
    return [*found, *beside]


def _as_elsewhere(done: Candidates, best: Candidate, label: str) -> list[Hypothesis]:
    """Beside an abrupt effect: one more as it was in the likeliest hypothesis that has it.

    A play that is fitted alone makes up for what else is missing, and what joins it for what that spoiled.
    """
    elsewhere = max((one for one in done.found.values() if label in one.names), key=done.score, default=None)
    if elsewhere is None or not best.point.hypothesis.is_abrupt:
        return []
    mine, other = best.point.hypothesis, elsewhere.point.hypothesis
    at = other.names.index(label)
    joined = mine.with_term(other.terms[at], other.opened[at])
    return [joined, replace(joined, numbers=other.numbers)]


def _beside_the_base(done: Candidates, best: Candidate, least: float) -> list[tuple[Hypothesis, float]]:
    """Names beside the base's numbers as they came, where these alone moved for more than a name costs.

    A gain or a lag of a sensor may look like three numbers that are wrong: from there a fit would not come
    back. Of names that promise half of what these brought, the own numbers are fitted first, the base's held:
    where that is right, a play has one minimum. What they promise from there is told.
    """
    if not done.may_give_way(best):
        return []
    base = done.problem.as_it_came
    near = done.at(base, best)
    near = done.judged(with_better_starts(done.problem, near.point))
    behind = done.score(best) - done.score(near)
    if behind < least:
        return []
    promised = promises(*done.as_it_is(near), _is_no_ripple)
    most = HALF * max([behind, *(one.gain for one in promised)])
    promised = [one for one in promised if one.gain > most]
    found = []
    for one in best_by_name(promised):
        held = done.fitted(base.with_term(one.use), near, held=frozenset(base.numbers))
        ahead = done.score(held) + done.promised(held).gain - done.score(best)
        if max(ahead, one.gain - behind) > least:
            starts = held.point.hypothesis, one.numbers.with_term(one.use)
            found.append((_likelier(done, near, *starts), max(ahead, one.gain - behind)))
    return found


def _is_no_ripple(use: EffectUse) -> bool:
    """Whether numbers of a base may look like an effect: like a ripple they do not."""
    return EFFECTS[use.id].law.follows is None


def _likelier(done: Candidates, near: Candidate, *starts: Hypothesis) -> Hypothesis:
    """Of hypotheses as they are, from where recordings begin in another."""
    return max(starts, key=lambda one: done.score(done.at(one, near)))


def _opened(done: Candidates, best: Candidate, show: Callable[[str], None]) -> Candidate:
    """With those optional numbers of its effects that earn their place, of the last one first."""
    for index in reversed(range(len(best.names))):
        best = _opened_of(done, best, index, show)
    return best


def _opened_of(done: Candidates, best: Candidate, index: int, show: Callable[[str], None]) -> Candidate:
    """With those optional numbers of one of its effects that earn their place, other laws before numbers."""
    parameters = EFFECTS[best.point.hypothesis.terms[index].id].parameters
    asked: tuple[Candidate, Problem, Linearised] | None = None
    for parameter in sorted(parameters, key=lambda one: not one.choices):
        wider = _wider(done, best.point.hypothesis, index, parameter)
        if not wider:
            continue
        if asked is None or asked[0] is not best:
            strays = done.strays(best.point.hypothesis)
            asked = best, *(done.where_led(best) if strays else done.as_it_is(best))
        gains = promised_by(*asked[1:], wider)
        if max(gains) <= done.cost_of_a_number(best):
            continue
        show(f"fitting {best.names[index]}: {parameter.name}")
        begins = wider[int(np.argmax(gains))]
        if 0.0 in parameter.opens:  # where it does nothing: a fit goes on from what is settled
            begins = begins.with_values(index, {parameter.name: 0.0}, begins.opened[index])
        tried = done.fitted(begins, best, LOOK)
        if done.score(tried) > done.score(best):  # the next one is judged by what this one leaves
            best = done.fitted(tried.point.hypothesis, tried)
    return best


def _wider(done: Candidates, hypothesis: Hypothesis, index: int, parameter: Parameter) -> list[Hypothesis]:
    """With an optional number of an effect where its file has it tried, or with another law of its choice."""
    use, opened = hypothesis.terms[index], hypothesis.opened[index]
    defaults = {one.name: one.default for one in EFFECTS[use.id].parameters}
    if parameter.beside and not any(
        name in opened or use.values[name] != defaults[name] for name in parameter.beside
    ):
        return []
    values = list(parameter.choices)
    if parameter.opens and parameter.name not in opened:
        first = EFFECTS[use.id].parameters[0]
        size = _BESIDE * abs(float(use.values[first.name])) if parameter.unit == first.unit else 0.0
        unit = Scene(done.problem, hypothesis).torque_nm if parameter.unit == "N m" else 1.0
        values = [one for one in (*(unit * value for value in parameter.opens), size, -size) if one]
    return [
        hypothesis.with_values(index, {parameter.name: value}, opened | {parameter.name})
        for value in values
        if value != float(use.values[parameter.name]) and parameter.lower <= value <= parameter.upper
    ]


def _pruned(done: Candidates, best: Candidate, show: Callable[[str], None]) -> Candidate:
    """Without those effects that later ones made needless, and without the last one if it takes nothing off.

    It may lead a fit out of a minimum that it was stuck in, and optional numbers that were opened beside it
    may be all that it brought. An effect that looks like the one that leaves may have an optional number for
    what that did, as limits of a motor have its peak.
    """
    for index in reversed(range(len(best.names))):
        fewer = done.fitted(best.point.hypothesis.without(index), best)
        gone = best.point.hypothesis.terms[index].id
        for place, use in enumerate(fewer.point.hypothesis.terms):
            if gone in EFFECTS[use.id].similar:
                fewer = _opened_of(done, fewer, place, show)
        if done.score(fewer) >= done.score(best):
            return _pruned(done, fewer, show)
    return best
