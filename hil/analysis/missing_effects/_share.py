"""What an effect is worth of its name: the share of the misfit beyond noise that goes with it.

It is what the effect takes off over that and what stays, where it lasts. That keeps a name modest where
something without a name is larger: a discrepancy that stays can make up a name that takes off less than
itself.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from hil.analysis.missing_effects._candidates import Candidates
from hil.analysis.missing_effects._fit import Linearised
from hil.analysis.missing_effects._hypothesis import Hypothesis
from hil.analysis.missing_effects._lasting import constancy
from hil.analysis.missing_effects._odds import Candidate, remains
from hil.analysis.missing_effects._orders import is_held, turns
from hil.analysis.missing_effects._outcome import Replay
from hil.analysis.missing_effects._search import HALF
from hil.core.effects import EFFECTS
from hil.core.model import EffectUse, Model

Array = npt.NDArray[np.float64]

LAW = 0.02
"""Of what an effect takes off is right in no law that bends; nor are its numbers known better."""


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
    """What an effect takes off over that and what stays, where it lasts; 0 of a ripple that is none."""
    if not _is_line(of.done, at, index):
        return 0.0
    lasts = constancy(of.done.problem, at, index, of.done.cost_of_a_number(best))
    return (1.0 - _remains(of, fewer, best, wrong)) * lasts


def wrong_by_laws(of: Judged, best: Candidate, fewer: Sequence[Candidate], index: int) -> Array:
    """Variance in each channel, (3,), that others' laws may get wrong without an effect; not linear ones.

    A law that is wrong by a share leaves that of what it takes off in every channel, so no more than where
    least stays.
    """
    left, alone = of.left(best), of.left(fewer[index])
    wrong = np.zeros(3)
    for other, use in enumerate(best.point.hypothesis.terms):
        if other != index and not is_linear(use):
            taken = np.maximum(of.left(fewer[other]) - left, 1e-300)
            wrong += min(LAW**2, float(np.nanmin(alone / taken))) * taken
    return wrong


def is_linear(use: EffectUse) -> bool:
    """Whether an effect changes the linear chain or what a sensor reads, and no law bends."""
    law = EFFECTS[use.id].law
    return (law.chain is not None or law.reads is not None) and law.tyre_rate is None


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
    if after.prior - before.prior > done.cost_of_a_number(after):
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
