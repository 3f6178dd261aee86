"""Stretches of recordings in which a model predicts the motion, and those in which none could.

An axle that bounces through a wide play is chaotic (E. Lorenz, J. Atmos. Sci. 20, 1963): two simulations that
begin as near to each other as any measurement can tell soon have nothing in common, and neither has the right
model with the measurement. A least squares descent finds no way there, and what is left says nothing of the
model. Elsewhere the same play forgets how it began. So a simulation is held against another whose torque is a
thousandth off: where they part far more than those of the plain model, errors do not count.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.data.trace import Flags
from hil.analysis.diagnosis.fit.fit import Fit, fit
from hil.analysis.diagnosis.fit.problem import SHAFT, Problem
from hil.analysis.diagnosis.search.thresholds import (
    AFTERMATH,
    CHAOTIC,
    LEAST_PREDICTED,
    MORE_PREDICTED,
    MOST_APART,
    MOST_OF_ERROR,
    MUCH_APART,
    PARTED_S,
    PLACES_NM,
    PREDICTED_ROUNDS,
    PREDICTED_SAME,
    PUSH,
    SOMEWHAT_APART,
    UNPREDICTED,
)
from hil.analysis.diagnosis.search.trimmed import trimmed, window_means

Array = npt.NDArray[np.float64]


def predicted_where(problem: Problem, base: Fit, one: Fit, *, fitted: bool = False) -> list[Flags] | None:
    """Of each recording the blocks that `one` predicts; None where it does so nearly everywhere.

    Args:
        base: the model without what is in question; how far apart its simulations come is the measure.
        fitted: `one` is at its best: where little is chaotic, but most of what it leaves lies there, that
            little is stated as well.
    """
    plain = float(np.median(np.concatenate(_parted(problem, base))))
    parted = _parted(problem, one)
    apart = [w > MUCH_APART * plain for w in parted]
    if fitted:
        apart = _with_aftermath(problem, one, apart, [w > SOMEWHAT_APART * plain for w in parted])
    chaotic = _share([w > CHAOTIC * plain for w in parted])
    if chaotic == 0.0 or (chaotic < UNPREDICTED and not (fitted and _holds_most(problem, one, apart))):
        return None
    lines = [w > MOST_APART for w in _parted_from_start(problem, one)]
    flags = []
    for trace, pushed, first in zip(problem.traces, apart, lines, strict=True):
        length = len(trace.measured)
        each = _blocks_near(problem, pushed | first, length)
        flags.append(~np.pad(each, (0, length - len(each)), mode="edge"))
    return flags


def where_predicted(
    problem: Problem, base: Fit, one: Fit, *, fitted: bool = False
) -> tuple[Problem, Fit] | None:
    """`one` fitted where it predicts the motion, and the problem judged there alone.

    None where it does so nearly everywhere; or so rarely that nothing could be stated of the rest.
    """
    judged, before = None, one
    for _ in range(PREDICTED_ROUNDS):
        flags = predicted_where(problem, base, one, fitted=fitted)
        if flags is None or _share(flags) < LEAST_PREDICTED:
            break
        judged = problem.judging(flags)
        before, one = one, fit(judged, one.hypothesis, one.starts, one.theta)
        if np.max(np.abs(one.theta - before.theta)) < PREDICTED_SAME:
            break
    return None if judged is None else (judged, one)


def counted_after_all(problem: Problem, base: Fit, named: Fit) -> tuple[Problem, Fit]:
    """`named` fitted wherever it predicts the motion itself: the law tried first may have predicted less.

    Flanks that damp, or pull, forget how a motion began where those that only bounce do not. Its numbers are
    taken from its better half: fitted with other stretches left out, they may miss that it is chaotic there.
    """
    whole = problem.judging_all()
    plain = fit(whole, base.hypothesis, base.starts, base.theta, rounds=0)
    flags = predicted_where(whole, plain, trimmed(whole, named), fitted=True)
    wider = whole if flags is None else whole.judging(flags)
    if _judged(wider) < _judged(problem) + MORE_PREDICTED:
        return problem, named
    return wider, fit(wider, named.hypothesis, named.starts, named.theta)


def _judged(problem: Problem) -> float:
    return _share([trace.judged_blocks for trace in problem.traces])


def left_out(problem: Problem) -> list[str]:
    """In words the stretches in which errors do not count."""
    words = []
    for trace in problem.traces:
        if trace.judged is None or trace.judged.all():
            continue
        share = 100.0 * (1.0 - float(np.mean(trace.judged)))
        words.append(
            f"{trace.name}: {share:.3g} % of it are not judged: the model does not predict its motion there "
            "(with noise of a thousandth of the torque, or started elsewhere in the play, it is another)"
        )
    return words


def _with_aftermath(
    problem: Problem, one: Fit, apart: Sequence[Flags], somewhat: Sequence[Flags]
) -> list[Flags]:
    """These windows, with those `somewhat` apart in which a fit leaves far more than in the middling one, and
    what follows them as long as it does.

    Motion that was chaotic for a while may come out of it another way, and go on so (a jump of a resonance).
    """
    length = _blocks_of_window(problem)
    powers = [
        window_means(np.sum(errors.channels**2, axis=1), length)[: len(flags)]
        for errors, flags in zip(one.errors, apart, strict=True)
    ]
    much = AFTERMATH * float(np.median(np.concatenate(powers)))
    wider = []
    for power, flags, less in zip(powers, apart, somewhat, strict=True):
        after = flags | (less & (power > much))
        for index in range(1, len(after)):
            after[index] |= after[index - 1] and power[index] > much
        wider.append(after)
    return wider


def _holds_most(problem: Problem, one: Fit, apart: Sequence[Flags]) -> bool:
    """Whether most of what a fit leaves lies in these windows, or beside them."""
    inside, whole = 0.0, 0.0
    for errors, flags in zip(one.errors, apart, strict=True):
        power = np.sum(errors.channels**2, axis=1)
        near = _blocks_near(problem, flags, len(power))
        inside += float(np.sum(power[: len(near)][near]))
        whole += float(np.sum(power))
    return inside > MOST_OF_ERROR * whole


def _blocks_near(problem: Problem, windows: Flags, count: int) -> Flags:
    """The blocks of these windows and of two on either side; at most `count`, as far as windows reach."""
    wide = np.convolve(windows, np.ones(5), "same") > 0.0
    return np.asarray(np.repeat(wide, _blocks_of_window(problem))[:count])


def _share(flags: Sequence[Flags]) -> float:
    return float(np.mean(np.concatenate(flags)))


def _blocks_of_window(problem: Problem) -> int:
    return max(1, round(PARTED_S / (problem.traces[0].dt * problem.traces[0].block)))


def _parted(problem: Problem, one: Fit) -> list[Array]:
    """How far a simulation and one with a torque that is a little off come apart: windows of a recording."""
    rng = np.random.default_rng(0)
    pushed = [
        replace(t, torque=t.torque + PUSH * float(np.max(np.abs(t.torque))) * rng.normal(size=len(t.torque)))
        for t in problem.traces
    ]
    other = replace(problem, traces=tuple(pushed))
    slots, sensors = one.hypothesis.packed(one.theta)
    found = []
    for index, start in enumerate(one.starts):
        shown = [p.outputs(index, slots[None], sensors[None], start[None])[0] for p in (problem, other)]
        found.append(_in_windows(problem, problem.changes(index, np.stack(shown))))
    return found


def _parted_from_start(problem: Problem, one: Fit) -> list[Array]:
    """The same of simulations that begin elsewhere in a play."""
    slots, sensors = one.hypothesis.packed(one.theta)
    found = []
    for index, start in enumerate(one.starts):
        tried = np.tile(start, (3, 1))
        tried[1:, SHAFT] += PLACES_NM[0], PLACES_NM[-1]
        shown = problem.outputs(index, np.tile(slots, (3, 1)), np.tile(sensors, (3, 1, 1)), tried)
        found.append(_in_windows(problem, problem.changes(index, shown)))
    return found


def _in_windows(problem: Problem, changes: Array) -> Array:
    """Rms of changes (sets x blocks x 3) in each window, of the set and channel that changes most."""
    length = min(_blocks_of_window(problem), changes.shape[1])
    count = changes.shape[1] // length
    parts = np.nan_to_num(changes[:, : count * length], nan=np.inf).reshape(len(changes), count, length, -1)
    return np.asarray(np.sqrt(np.mean(parts**2, axis=2)).max(axis=(0, 2)))
