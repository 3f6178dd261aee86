"""Rivals: what may stand in the place of what the best hypothesis has, fitted so that odds count it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from hil.analysis.missing_effects._candidates import LOOK, Candidates
from hil.analysis.missing_effects._hypothesis import Hypothesis, label_of
from hil.analysis.missing_effects._mismatch import is_off, tolerance
from hil.analysis.missing_effects._odds import ALIKE, Candidate
from hil.analysis.missing_effects._screen import NUMBERS, Scene, may_join
from hil.core.effects import EFFECTS, Effect
from hil.core.model import EffectUse

_ALONE = 2  # single names that may take a place near noise
_RIVALS = 3  # names that may take the place of another


def fit_twins(done: Candidates, best: Candidate, least: float, *, far: bool) -> None:
    """Fit each other gain in the place of a gain, or of numbers that moved, and each other sensor's error.

    An axle shows the same by them. Which of them it is only what the base says can tell, and that is far
    behind where numbers have moved.

    Args:
        far: most numbers are not what the base says.
    """
    hypothesis = best.point.hypothesis
    places = [(hypothesis.without(index), use) for index, use in enumerate(hypothesis.terms)]
    twins = [(fewer, twin) for fewer, use in places for twin in _twins_of(done, fewer, use)]
    if done.may_give_way(best, far=far):
        twins = [(hypothesis, gain) for gain in _gains_of(done, hypothesis)]
    for fewer, twin in twins:
        if label_of(twin) not in fewer.names:
            rival = replace(fewer, terms=(), opened=()).with_term(twin)
            for begins in _in_its_place(done, best, fewer, rival):
                done.fitted(begins, best, at_least=least)


def fit_in_place(
    done: Candidates, best: Candidate, asked: Callable[[EffectUse], bool] = lambda _: True
) -> None:
    """Far from noise, fit the best hypothesis with each name in turn replaced by others.

    A forward search finds a name beside those before it; names that could stand in its place must be given
    the chance, or the data would seem to tell them apart. Near noise the likeliest of those that were left
    behind are fitted to their end, and of several names each gives way to the likeliest single ones, from the
    base's numbers as well: what was missing beside them then may have decided between them. Nor may several
    names stand where one of these does alone, beside numbers that they have put right.
    """
    pool = sorted(done.found.values(), key=done.score, reverse=True)
    least = done.score(best) - ALIKE  # what is less likely decides nothing
    if done.problem.is_noise(best.point.errors):
        for one in [one for one in pool if len(one.names) == len(best.names)][: _RIVALS + 1]:
            if one.names != best.names and done.may_reach(one) > least:
                done.fitted(one.point.hypothesis, one, at_least=least)
        alone = [one for one in pool if len(one.names) == 1 and one.names[0] not in best.names]
        for single in alone[:_ALONE] if len(best.names) > 1 else ():
            mine = replace(single.point.hypothesis, numbers=best.point.hypothesis.numbers)
            done.fitted(mine, best, at_least=least)
        for index in range(len(best.names)) if len(best.names) > 1 else ():
            for single in alone[:_ALONE]:
                fewer = best.point.hypothesis.without(index)
                for begins in _in_its_place(done, best, fewer, single.point.hypothesis):
                    done.fitted(begins, best, at_least=least)
        return
    terms: dict[str, tuple[EffectUse, frozenset[str]]] = {}
    for one in pool:
        for label, use, opened in zip(
            one.names, one.point.hypothesis.terms, one.point.hypothesis.opened, strict=True
        ):
            if asked(use) and label not in best.names:
                terms.setdefault(label, (use, opened))
    for index, use in enumerate(best.point.hypothesis.terms):
        fewer = best.point.hypothesis.without(index)
        for rival in [*terms.values()][:_RIVALS] if asked(use) else ():
            done.fitted(fewer.with_term(*rival), best, at_least=least)


def _in_its_place(
    done: Candidates, best: Candidate, fewer: Hypothesis, other: Hypothesis
) -> list[Hypothesis]:
    """The best hypothesis, `fewer` of its effects and a rival in their place, where a fit may begin.

    They are the likelier of its own and the rival's; and the base's, to which the effects were fitted first.
    """
    joined = fewer.with_term(other.terms[0], other.opened[0])
    near = max(joined, replace(joined, numbers=other.numbers), key=lambda one: done.score(done.at(one, best)))
    if not done.has_moved(best):
        return [near]
    as_it_came = replace(joined, numbers=done.problem.as_it_came.numbers)
    held = done.fitted(as_it_came, best, LOOK, held=frozenset(joined.numbers))
    return [near, held.point.hypothesis]


def without(done: Candidates, best: Candidate, index: int) -> Candidate:
    key = tuple(sorted(name for at, name in enumerate(best.names) if at != index))
    return done.found.get(key) or done.fitted(best.point.hypothesis.without(index), best)


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
        if base <= 0.0 or abs(hypothesis.numbers[name] - base) <= tolerance(name, base, done):
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
    """Of each number that moved where nothing is named: errors of sensors that do as well in its place.

    A gear ratio and a gain of one of two speeds show the same: only the prior knows that teeth were counted.
    So do a dead time and a skew of the only output. One thing is wrong in either case, so names cost alike.
    """
    if best.names:
        return {}
    hypothesis, found = best.point.hypothesis, {}
    least = done.score(best) - ALIKE - done.cost_of_a_number(best)
    for name in [one for one in done.has_moved(best) if is_off(one, hypothesis, done)]:
        base = done.problem.as_it_came.numbers[name]
        back = hypothesis.with_number(name, base)
        uses = _gains_of(done, back)
        if name == NUMBERS["dead_time"] and len(Scene(done.problem, back).channels) == 1:
            late_s = hypothesis.numbers[name] - base
            late = _on_each_channel(done, back, EFFECTS["channel_skew"])
            uses = [EffectUse(use.id, use.values | {"delay_s": late_s}) for use in late]
        held = frozenset({name})
        tried = [done.fitted(back.with_term(use), best, held=held, at_least=least) for use in uses]
        alike = [
            one for one in tried if one.log_likelihood + one.prior > best.log_likelihood + best.prior - ALIKE
        ]
        found[name] = tuple(one.names[0] for one in sorted(alike, key=done.score, reverse=True))
    return found


def _gains_of(done: Candidates, hypothesis: Hypothesis) -> list[EffectUse]:
    """Gains that may join, of each channel that was recorded, of one."""
    effects = [one for one in EFFECTS.values() if one.off == 1.0 and may_join(one, hypothesis)]
    return [use for one in effects for use in _on_each_channel(done, hypothesis, one)]


def _twins_of(done: Candidates, hypothesis: Hypothesis, use: EffectUse) -> list[EffectUse]:
    """What may show the same as a gain, or as an error of a sensor, in its place: where it does nothing."""
    effect = EFFECTS[use.id]
    if effect.off == 1.0:
        return _gains_of(done, hypothesis)
    others = _on_each_channel(done, hypothesis, effect) if "channel" in use.values else []
    return [one for one in others if label_of(one) != label_of(use)]


def _on_each_channel(done: Candidates, hypothesis: Hypothesis, effect: Effect) -> list[EffectUse]:
    channels = Scene(done.problem, hypothesis).channels if effect.text_parameters else ()
    number: dict[str, float | str] = {effect.parameters[0].name: effect.off}
    return [EffectUse(effect.id, number | {"channel": name}) for name in channels] or [
        EffectUse(effect.id, number)
    ]
