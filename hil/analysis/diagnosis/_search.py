"""From scores to names: fits of the promising effects, forward and backward steps, when to stop.

A name must earn its place three times: by evidence (the drop of the squared error against the noise,
deflated by the colour of what is left), by size (the share of the remaining gap that it closes), and by
need (without it, all others refitted, the gap opens again).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis._coordinates import Hypothesis, key_of
from hil.analysis.diagnosis._fit import Fit, fit
from hil.analysis.diagnosis._problem import Problem
from hil.analysis.diagnosis._screen import Score, screen
from hil.core.model import EffectUse

Array = npt.NDArray[np.float64]

LEAST_EVIDENCE = 45.0  # drop of the squared error in noise variances, after deflation
_LEAST_SHARE = 0.5  # of the remaining excess over the noise that one effect must close
_LEAST_OF_ALL = 2e-3  # of the first excess: below it, a formula differs and no effect is missing
_LEAST_OF_NOISE = 2.5e-3  # of the noise's power: a smaller gap matters to nobody
_FLOOR_REACH = (0.9, 1.03)
_PRICE = 8.0  # of each parameter that an effect brings, when two effects explain the same
_MOST_EFFECTS = 3
_PAIR_STARTS = 3
_LEAST_PAIR_SHARE = 0.75
_RACE = 5  # candidates that are fitted at each step
_PROMISING = 0.4  # share of the best score
_RACE_ROUNDS = 3
_OUT_OF_RACE = 2.5  # times the best cost after the first rounds
#: The second of each pair likes to mend the formula of the first: it must close nearly all that is left.
_MIMICS = (
    ("backlash", "shaft_cubic_stiffness"),
    ("backlash", "shaft_hysteresis"),
    ("coulomb_friction", "shaft_hysteresis"),
    ("shaft_hysteresis", "shaft_cubic_stiffness"),
    ("torque_rate_limit", "shaft_cubic_stiffness"),
)
_MIMIC_SHARE = 0.85
_RELATIVES = {
    "dead_time": ("actuator_lag",),
    "actuator_lag": ("dead_time",),
    "coulomb_friction": ("running_resistance",),
    "running_resistance": ("coulomb_friction", "viscous_drag"),
    "viscous_drag": ("running_resistance",),
    "mount_mode": ("shaft_cubic_stiffness",),
    "shaft_cubic_stiffness": ("shaft_hysteresis",),
    "shaft_hysteresis": ("coulomb_friction",),
}


@dataclass
class Step:
    """One forward step: what was tried on top of `parent`, best first."""

    parent: Fit
    scores: list[Score]
    fits: list[Fit]


@dataclass
class Found:
    """The base model at its best, the accepted hypothesis, and everything that was considered."""

    base: Fit
    best: Fit
    steps: list[Step] = field(default_factory=list)
    dropped: list[tuple[tuple[str, str], float]] = field(default_factory=list)


def search(problem: Problem, base: Hypothesis, show: Callable[[str], None]) -> Found:
    """Find the effects that the base model lacks."""
    show("fitting the base model")
    first = fit(problem, base)
    found = Found(first, first)
    while len(found.best.hypothesis.terms) < _MOST_EFFECTS:
        slack = 2.0 * np.sqrt(problem.rows)
        if found.best.hypothesis.terms and _excess(problem, found.best) + slack < _worthwhile(
            problem, found.base
        ):
            break
        show(f"looking for effect {len(found.best.hypothesis.terms) + 1}")
        scores = screen(problem, found.best)
        if not scores or scores[0].gain < _worthwhile(problem, found.base):
            found.steps.append(Step(found.best, scores, []))
            break
        step = Step(found.best, scores, _race(problem, found.best, scores))
        found.steps.append(step)
        winner = _refined(problem, step.fits[0])
        step.fits[0] = winner
        if not accepted(problem, found.base, found.best, winner):
            pair = _pair(problem, found, step.fits) if not found.best.hypothesis.terms else None
            if pair is None:
                break
            winner = pair
        found.best = winner
        found = _backward(problem, found)
    return found


def _pair(problem: Problem, found: Found, fits: list[Fit]) -> Fit | None:
    """Two effects that close the gap together where neither does alone."""
    best: Fit | None = None
    for parent in fits[:_PAIR_STARTS]:
        if evidence(problem, found.base, parent) < LEAST_EVIDENCE:
            continue
        scores = screen(problem, parent)
        for one in _race(problem, parent, scores[:_PAIR_STARTS]) if scores else []:
            if best is None or one.total < best.total:
                best = one
    if best is None or _share(problem, found.base, best) < _LEAST_PAIR_SHARE:
        return None
    drop = found.base.total - best.total
    enough = evidence(problem, found.base, best) > 2 * LEAST_EVIDENCE and drop > 0
    return best if enough else None


def grown(problem: Problem, parent: Fit, use: EffectUse, rounds: int) -> Fit:
    """`parent` with one effect more, refitted."""
    hypothesis = parent.hypothesis.with_term(use)
    return fit(problem, hypothesis, parent.starts, carried(parent, hypothesis), rounds=rounds)


def carried(parent: Fit, hypothesis: Hypothesis) -> Array:
    """Coordinates of `hypothesis`: those that `parent` has by their fitted values, others by their start."""
    terms = {key_of(t): i for i, t in enumerate(parent.hypothesis.terms)}
    known = {(c.name, c.term): v for c, v in zip(parent.hypothesis.coordinates(), parent.theta, strict=True)}
    values = hypothesis.start()
    wrong = {str(t.values["parameter"]) for t in hypothesis.terms if t.id == "parameter_mismatch"}
    for index, c in enumerate(hypothesis.coordinates()):
        term = -1 if c.term < 0 else terms.get(key_of(hypothesis.terms[c.term]), -2)
        if term == -1 and c.name in wrong and ("parameter_mismatch", c.name) not in terms:
            continue
        values[index] = known.get((c.name, term), values[index])
    return values


def floor_of(problem: Problem, one: Fit) -> float:
    """The squared error that noise alone would leave, from neighbouring errors of `one` itself.

    Half the mean squared difference of neighbours is the variance of white noise and leaves out what is slow;
    it may correct the spectral noise level by a few percent only.
    """
    total = 0.0
    for error, _, _ in one.pieces:
        e = error.reshape(-1, 3)
        total += 0.5 * float(np.sum(np.diff(e, axis=0) ** 2)) * len(e) / (len(e) - 1)
    return float(np.clip(total, _FLOOR_REACH[0] * problem.rows, _FLOOR_REACH[1] * problem.rows))


def _excess(problem: Problem, one: Fit) -> float:
    return max(one.total - floor_of(problem, one), 0.0)


def _worthwhile(problem: Problem, base: Fit) -> float:
    """The least drop of the squared error that can earn a name."""
    least = max(LEAST_EVIDENCE, _LEAST_OF_NOISE * problem.rows)
    return max(least, _LEAST_OF_ALL * (base.total - problem.rows))


def _race(problem: Problem, parent: Fit, scores: list[Score]) -> list[Fit]:
    """Fits of the promising effects, best first; the hopeless are given up after a few rounds."""
    chosen = _chosen(scores)
    if not chosen:
        return []
    fits = [grown(problem, parent, score.use, _RACE_ROUNDS) for score in chosen]
    floor = float(problem.rows)
    best = min(f.total for f in fits)
    finished = []
    for one in fits:
        if one.rounds >= _RACE_ROUNDS and one.total - floor < _OUT_OF_RACE * (best - floor) + 1e3:
            finished.append(fit(problem, one.hypothesis, one.starts, one.theta))
        else:
            finished.append(one)
    return sorted(finished, key=lambda f: f.total + _PRICE * len(f.theta))


def _chosen(scores: list[Score]) -> list[Score]:
    top = [s for s in scores[:_RACE] if s.gain > max(LEAST_EVIDENCE / 2, _PROMISING * scores[0].gain)]
    wanted = {name for s in top[:2] for name in _RELATIVES.get(s.key[0], ())}
    have = {s.key[0] for s in top}
    return top + [s for s in scores if s.key[0] in wanted - have and s.gain > 0.1 * scores[0].gain]


def _refined(problem: Problem, best: Fit) -> Fit:
    """Optional parameters of dry friction, where they pay."""
    for term in best.hypothesis.terms:
        if term.id == "coulomb_friction":
            for names in (("stribeck_torque_nm",), ("offset_nm",)):
                opened = Hypothesis(
                    best.hypothesis.base, best.hypothesis.terms, (*best.hypothesis.open, *names)
                )
                tried = fit(problem, opened, best.starts, _opened(best, opened))
                if _share(problem, best, tried) > 0.2 and evidence(problem, best, tried) > LEAST_EVIDENCE:
                    best = tried
    return best


def _opened(best: Fit, opened: Hypothesis) -> Array:
    known = {(c.name, c.term): v for c, v in zip(best.hypothesis.coordinates(), best.theta, strict=True)}
    start = opened.start()
    return np.array(
        [known.get((c.name, c.term), s) for c, s in zip(opened.coordinates(), start, strict=True)]
    )


def accepted(problem: Problem, base: Fit, poorer: Fit, richer: Fit) -> bool:
    """Whether `richer` earns its further name."""
    mimics = any({a, b} <= set(richer.hypothesis.ids) for a, b in _MIMICS)
    return (
        evidence(problem, poorer, richer) > LEAST_EVIDENCE
        and _share(problem, poorer, richer) > (_MIMIC_SHARE if mimics else _LEAST_SHARE)
        and poorer.total - richer.total > _worthwhile(problem, base)
    )


def evidence(problem: Problem, poorer: Fit, richer: Fit) -> float:
    """Twice the log-likelihood ratio, deflated by the correlation time of the richer fit's errors."""
    rows = problem.rows
    ratio = max(poorer.total, 1.0) / max(richer.total, 1.0)
    return float(rows * np.log(max(ratio, 1e-9)) / colour(richer))


def colour(one: Fit) -> float:
    """How many neighbouring errors count as one: 1 for white errors, more for coloured ones."""
    rise, power = 0.0, 0.0
    for error, _, _ in one.pieces:
        e = error.reshape(-1, 3)
        power += float(np.sum(e * e))
        for lag in (1, 2, 3, 5, 8, 13, 21):
            rise += _SPAN[lag] * float(np.sum(e[lag:] * e[:-lag]))
    return max(1.0, 1.0 + 2.0 * rise / max(power, 1e-12))


_SPAN = {1: 1, 2: 1, 3: 1.5, 5: 2.5, 8: 4, 13: 6.5, 21: 8}


def _share(problem: Problem, poorer: Fit, richer: Fit) -> float:
    """Share of the excess over the noise that the richer fit closes; what noise may hide counts as closed."""
    drop = poorer.total - richer.total
    excess = poorer.total - floor_of(problem, richer) - 2.0 * np.sqrt(problem.rows)
    return float(drop / max(excess, drop, 1e-9))


def _backward(problem: Problem, found: Found) -> Found:
    """Drop effects that the later ones made needless."""
    best = found.best
    for index in range(len(best.hypothesis.terms) - 1):
        fewer = best.hypothesis.without(index)
        tried = fit(problem, fewer, best.starts, carried(best, fewer))
        if not accepted(problem, found.base, tried, best):
            found.dropped.append((key_of(best.hypothesis.terms[index]), tried.total - best.total))
            found.best = tried
            return found
    return found
