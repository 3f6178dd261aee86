"""All hypotheses that were fitted, and how one more is fitted and judged."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np

from hil.analysis.missing_effects._fit import (
    ROUNDS,
    Linearised,
    Point,
    fit,
    linearised,
    point_at,
    with_better_starts,
)
from hil.analysis.missing_effects._hypothesis import Hypothesis, bends
from hil.analysis.missing_effects._odds import ALIKE, Candidate
from hil.analysis.missing_effects._orders import count_of_orders
from hil.analysis.missing_effects._phase import tracked
from hil.analysis.missing_effects._problem import Problem
from hil.analysis.missing_effects._projection import Explained, Projection
from hil.analysis.missing_effects._screen import may_join
from hil.core.effects import EFFECTS

_SETTLED = 0.1  # growth of log likelihood between rounds that ends them
GROWING = 1.0
"""Growth of log likelihood above which a fit goes on: what it lacks would look like another name."""
MOST_ROUNDS = 4 * ROUNDS
LOOK = 2  # rounds, after which it is known whether a fit pays
_TO_FIRST_ORDER = 2.0  # times what numbers promise may a fit bring
_LED_S = (0.002, 0.02)  # within which recorded speeds lead, at first closely
_ASTRAY = 2.0  # noises left, above which they do
_OF_A_SAMPLE = (0.02, 0.25, 0.5, 0.75, 0.98)  # where a dead time may be within the sample that it ends in


@dataclass
class Candidates:
    """All hypotheses that were fitted, the best of each set of names, and what they are weighed by."""

    problem: Problem
    values: float = 2.0  # independent ones that the data hold, by the best hypothesis so far
    found: dict[tuple[str, ...], Candidate] = field(default_factory=dict)

    @property
    def best(self) -> Candidate:
        """The hypothesis with the highest score."""
        return max(self.found.values(), key=self.score)

    def score(self, candidate: Candidate) -> float:
        """Of a candidate, at what the data hold."""
        return candidate.score(self.values)

    def cost_of_a_number(self, candidate: Candidate) -> float:
        """What one more free number must let log L grow by."""
        return self.score(candidate) - self.score(replace(candidate, free=candidate.free + 1))

    def least(self, best: Candidate) -> float:
        """What a name more must promise."""
        return self.cost_of_a_number(best) * self._times(best)

    def gains(self, best: Candidate, grown: Candidate) -> bool:
        """Whether a name more pays."""
        grew = grown.log_likelihood - best.log_likelihood
        costs = grew - (self.score(grown) - self.score(best))
        return grew > costs * self._times(best)

    def _times(self, best: Candidate) -> float:
        """How often a name more must bring its cost: where noise is left, more than slow noise would give."""
        if not self.problem.is_noise(best.point.errors):
            return 1.0
        level, most = self.problem.noise_in(best.point.errors)
        return float(np.nanmax(most / level))

    def may_gain(self, candidate: Candidate) -> bool:
        """Whether one more name is to be looked for, and could pay."""
        return self.could_pay(candidate) and not self.problem.is_right(candidate.point.errors)

    def could_pay(self, candidate: Candidate) -> bool:
        """Whether one more name would pay, if it left nothing but noise."""
        least = math.log(candidate.known) + self.least(candidate)
        return self.problem.most_to_gain(candidate.point.errors) > least

    def may_give_way(self, candidate: Candidate, *, far: bool = False) -> bool:
        """Whether a name could do in the place of numbers that moved: it brings what they cost at most.

        Args:
            far: the base says nothing of them.
        """
        least = math.log(candidate.known) + self.cost_of_a_number(candidate)
        costs = -replace(self.problem, far=far).log_prior(candidate.point.hypothesis)
        most = self.problem.most_to_gain(candidate.point.errors) + costs
        return not candidate.names and most > least - ALIKE

    def has_moved(self, candidate: Candidate) -> list[str]:
        """Numbers that are not what the base says at odds of 20 : 1."""
        coordinates = self.problem.coordinates(candidate.point.hypothesis)
        return [one.name for one in coordinates if math.log1p(one.away(0.0) ** 2) > ALIKE and one.term < 0]

    def go_on_from(self, best: Candidate) -> Candidate:
        """Weigh errors by what the best hypothesis leaves; it, with what follows angles as these are now."""
        powers = best.point.powers(self.problem)
        self.values = powers.values(self.problem.noise)
        turned, hypothesis = tracked(self.problem, best.point)
        self.problem = turned.weighed_by(powers.spectrum(self.problem.noise))
        follows = any(EFFECTS[use.id].law.follows for use in hypothesis.model().effects)
        return self.at(hypothesis, best) if follows else best

    def weighed_as(self, candidate: Candidate, *, once: bool = False) -> Problem:
        """The problem, errors weighed by the spectrum that a candidate leaves itself.

        Args:
            once: what a torque that repeats itself shows again and again counts once, as in odds and errors.
        """
        return self.problem.weighed_as(candidate.point.errors, once=once)

    def promised(self, candidate: Candidate) -> Explained:
        """What its numbers may still bring a candidate, weighed by what it leaves."""
        return Projection(*self.as_it_is(candidate)).alone

    def as_it_is(self, candidate: Candidate) -> tuple[Problem, Linearised]:
        """The problem weighed by what a candidate leaves, and that point."""
        problem = self.weighed_as(candidate)
        return problem, linearised(problem, candidate.point)

    def where_led(self, candidate: Candidate) -> tuple[Problem, Linearised]:
        """The same where recorded speeds lead."""
        led = self.led(candidate.point)
        problem = self.led_problem.weighed_as(led.errors)
        return problem, linearised(problem, led)

    def may_reach(self, candidate: Candidate) -> float:
        """The score to which its numbers may still bring a candidate, by what they promise."""
        return self.score(candidate) + _TO_FIRST_ORDER * max(self.promised(candidate).gain, 0.0)

    def fitted(
        self,
        hypothesis: Hypothesis,
        near: Candidate | None,
        rounds: int = ROUNDS,
        held: frozenset[str] = frozenset(),
        at_least: float = -math.inf,
    ) -> Candidate:
        """Fit a hypothesis, weighed by the spectrum that it leaves itself; the best of its names is kept.

        Args:
            held: numbers of the base that stay what they are.
            at_least: a score; a fit ends where neither its last round nor its numbers promise to reach it.
                Not in its first rounds: where numbers are off they promise little.
        """
        goes_on = near is not None and near.point.hypothesis is hypothesis
        point = near.point if near and goes_on else self._begun(hypothesis, near)
        if self.strays(hypothesis) and not goes_on and (near is None or self.is_astray(near)):
            led = self.led(point, held)
            led = with_better_starts(self.problem, point_at(self.problem, led.hypothesis, led.starts))
            point = max(point, led, key=lambda one: self.score(self.judged(one)))
        best = before = self.judged(point)
        problem = self.problem
        if goes_on:
            problem = self.weighed_as(best)
        elif hypothesis.kind == "rigid":  # slow errors of a mass are friction; a chain's bend its resonances
            problem = problem.weighed_by_noise()
        for number in range(rounds if rounds < ROUNDS else MOST_ROUNDS):
            # slow misfit would trade a dead time for anything, until errors are weighed by their colour
            point = fit(problem, point, held if number or goes_on else held | {"torque_delay"})
            after = self.judged(point)
            best = max(best, after, key=self.score)
            growth = after.log_likelihood - before.log_likelihood
            if abs(growth) < _SETTLED or (number >= ROUNDS - 1 and growth < GROWING):
                break
            known = goes_on or number + 1 >= LOOK
            if known and self.score(after) + growth < at_least and self.may_reach(after) < at_least:
                return self._kept(best)
            before = after
            problem = self.weighed_as(after)
        if rounds >= ROUNDS:
            if hypothesis.kind == "rigid" and "torque_delay" not in held:
                best = self._within_a_sample(best)
            best = self._with_less(best)
        return self._kept(best)

    def _kept(self, fitted: Candidate) -> Candidate:
        """What was fitted, the best of its names among what was found."""
        key = tuple(sorted(fitted.names))
        self.found[key] = max(self.found.get(key, fitted), fitted, key=self.score)
        return fitted

    def led(self, point: Point, held: frozenset[str] = frozenset()) -> Point:
        """A hypothesis fitted where recorded speeds lead it, its errors those of `led_problem`.

        What bends makes minima at wrong numbers: where a motion went astray nothing leads it back. Coupled to
        what was recorded it comes back by itself, and one minimum stays (H. Abarbanel, D. Creveling, R.
        Farsian, M. Kostuk, SIAM J. Appl. Dyn. Syst. 8 (2009) 1341).
        """
        led = point
        for time_s in _LED_S:
            problem, had = replace(self.problem, led_s=time_s), -math.inf
            led = point_at(problem, led.hypothesis, led.starts)
            for _ in range(ROUNDS):
                powers = led.powers(problem)
                has = float(np.sum(powers.log_likelihood(problem.noise)))
                if has < had + GROWING:
                    break
                led, had = fit(problem.weighed_by(powers.spectrum(problem.noise)), led, held), has
        return led

    def strays(self, hypothesis: Hypothesis) -> bool:
        """Whether an effect may send motion astray."""
        return hypothesis.is_abrupt or (hypothesis.kind != "rigid" and any(map(bends, hypothesis.terms)))

    def is_astray(self, near: Candidate) -> bool:
        """Whether a candidate leaves so much that motion may go its own way."""
        left = self.problem.mean_square(near.point.errors) / self.problem.noise**2
        return bool(np.nanmax(left) > _ASTRAY**2)

    @property
    def led_problem(self) -> Problem:
        """The problem where recorded speeds lead each simulation."""
        return replace(self.problem, led_s=_LED_S[-1])

    def _within_a_sample(self, best: Candidate) -> Candidate:
        """With the likeliest dead time of those that delay a rigid axle by as many samples.

        Its shaft torque steps with the sample that a request falls in. A slope over a whole one does not lead
        through it.
        """
        hypothesis, starts = best.point.hypothesis, best.point.starts
        if "torque_delay" not in hypothesis.numbers:
            return best
        sample_s = self.problem.series[0].dt
        whole = math.floor(hypothesis.numbers["torque_delay"] / sample_s)
        tried = [
            self.judged(point_at(self.problem, hypothesis.with_number("torque_delay", delay_s), starts))
            for delay_s in (
                hypothesis.base.parameters["torque_delay"],
                *((whole + share) * sample_s for share in _OF_A_SAMPLE),
            )
        ]
        likeliest = max(tried, key=self.score)
        if self.score(likeliest) < self.score(best) + _SETTLED:
            return best
        settled = fit(self.weighed_as(likeliest), likeliest.point, frozenset({"torque_delay"}))
        return max(best, likeliest, self.judged(settled), key=self.score)

    def _with_less(self, best: Candidate) -> Candidate:
        """Without a number of an effect that acts by several, where that one does next to nothing."""
        for index, use in enumerate(best.point.hypothesis.terms):
            acting = EFFECTS[use.id].acting_with()
            for name in acting if len(acting) > 1 else ():
                opened = best.point.hypothesis.opened[index]
                less = best.point.hypothesis.with_values(index, {name: 0.0}, opened)
                point = point_at(self.problem, less, best.point.starts)
                held = self.judged(fit(self.weighed_as(best), point, frozenset({name})))
                best = max(best, held, key=self.score)
        return best

    def _begun(self, hypothesis: Hypothesis, near: Candidate | None) -> Point:
        """A hypothesis as it is, from starts of another; as measured where it sticks and these may be off."""
        if near is None:
            return point_at(self.problem, hypothesis)
        point = point_at(self.problem, hypothesis, near.point.starts)
        if hypothesis.kind != "rigid" or not any(EFFECTS[use.id].law.dry for use in hypothesis.terms):
            return point
        fresh = with_better_starts(self.problem, point_at(self.problem, hypothesis))
        return max(point, fresh, key=lambda one: self.judged(one).log_likelihood)

    def at(self, hypothesis: Hypothesis, near: Candidate) -> Candidate:
        """A hypothesis as it is, from the starts of another."""
        return self.judged(point_at(self.problem, hypothesis, near.point.starts))

    def judged(self, point: Point) -> Candidate:
        """A fitted point with what it is weighed by."""
        hypothesis = point.hypothesis
        known = sum(may_join(effect, Hypothesis(hypothesis.base, {})) for effect in EFFECTS.values())
        coordinates = self.problem.coordinates(hypothesis)
        prior = self.problem.log_prior(hypothesis)
        windows = point.powers(self.problem).log_likelihood(self.problem.noise)
        sides = [side for use in hypothesis.terms if (side := EFFECTS[use.id].law.follows)]
        places = sum(math.log(max(count_of_orders(self.problem, side), 1.0)) for side in sides)
        free = sum(not one.is_idle for one in coordinates)
        return Candidate(point, windows, free, known, prior, places)
