"""A base model whose numbers are far off, and descents that begin near a fit.

Descents that begin near a fit, by the derivatives that it has.

Derivatives cost a simulation for each number and each initial value; near where they were taken they serve
again, and a step costs as many simulations as lengths of it are tried.

A base model whose numbers are far off: identified anew, slow motion first.

A least squares descent on a whole recording finds the nearest minimum, and a resonance that is a third off is
behind several. Means over a quarter of a second know nothing of resonances: they set inertias and losses.
Shorter means then add what swings faster, each fit from where the one before ended (frequency continuation,
as in the inversion of seismic waves: Bunks et al., Geophysics 60, 1995).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.data.trace import Flags, Trace, blocks
from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.fit.errors import Errors
from hil.analysis.diagnosis.fit.fit import Fit, bounds_of, fit, precision_of
from hil.analysis.diagnosis.fit.least_squares import box_step
from hil.analysis.diagnosis.fit.normal import reduced, start_step
from hil.analysis.diagnosis.fit.problem import Problem, problem_of
from hil.analysis.diagnosis.fit.thresholds import COARSE_BLOCKS, COARSE_S, FAR_ROUNDS, SLIDE_ROUNDS, TRIALS

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Slid:
    """Where a descent by another fit's derivatives ended: `total` as that of a fit."""

    theta: Array
    starts: list[Array]
    total: float


def slid(problem: Problem, near: Fit, theta: Array, starts: list[Array]) -> Slid:
    """Go down from `theta` and `starts` by the derivatives of the fit `near`, while it gains something.

    Raises:
        OutOfTimeError: the problem's allowance is used up.
    """
    lower, upper = bounds_of(near.hypothesis)
    precision = precision_of(problem, near.hypothesis)
    theta = np.clip(theta, lower, upper)
    shares: tuple[float, ...] = (0.0,)  # where it begins is looked at first
    step, now, errors = np.zeros(len(theta)), np.inf, near.errors
    steps = [np.zeros(len(start)) for start in starts]
    for _ in range(SLIDE_ROUNDS):
        thetas = [theta + share * step for share in shares]
        each = [np.stack([s + share * d for share in shares]) for s, d in zip(starts, steps, strict=True)]
        tried = problem.tried([near.hypothesis.packed(t) for t in thetas], each)
        totals = tried.costs + np.array([float(precision @ t**2) for t in thetas])
        best = int(np.argmin(totals))
        if not totals[best] < now:
            break
        theta, starts, now = thetas[best], [one[best] for one in each], float(totals[best])
        errors = tuple(
            Errors(r[best], e.by_coordinate, e.by_start) for r, e in zip(tried.rows, near.errors, strict=True)
        )
        normals = problem.normals(errors, starts)
        matrix, gradient = reduced(normals)
        step = box_step(
            matrix + np.diag(precision), gradient - precision * theta, lower - theta, upper - theta
        )
        steps = [start_step(n, step) for n in normals]
        shares = TRIALS
    return Slid(theta, starts, now)


def identified(problem: Problem, hypothesis: Hypothesis) -> tuple[Problem, Fit]:
    """The base model of `hypothesis` with all parameters free, at its best.

    With it the problem that says how far errors are from noise: what recordings do not tell stays as it was.
    """
    freed = replace(hypothesis, far=True)
    theta, starts = freed.start(), problem.first_starts()
    for seconds in COARSE_S:
        coarse = _coarser(problem, seconds)
        if coarse is None:
            continue
        reached = fit(coarse, freed, starts, theta, rounds=FAR_ROUNDS)
        theta, starts = reached.theta, reached.starts
    reached = fit(problem, freed, starts, theta)
    known = replace(problem, misfit=max(1.0, reached.cost / problem.rows))
    return known, fit(known, freed, reached.starts, reached.theta)


def _coarser(problem: Problem, seconds: float) -> Problem | None:
    """The same recordings in means over `seconds`; None where the shortest has too few of them."""
    finest = problem.traces[0]
    block = round(seconds / finest.dt)
    if block <= finest.block or min(len(t.samples) for t in problem.traces) < COARSE_BLOCKS * block:
        return None
    return problem_of(
        _with_block(problem.traces, block),
        problem.noise,
        problem.gear_ratio,
        floor=problem.floor,
        allowance=problem.allowance,
    )


def _with_block(traces: Sequence[Trace], block: int) -> list[Trace]:
    return [
        replace(t, block=block, measured=blocks(t.samples, block), judged=_judged(t, block)) for t in traces
    ]


def _judged(trace: Trace, block: int) -> Flags | None:
    """Blocks of another length in which every sample counts."""
    if trace.judged is None:
        return None
    return np.asarray(blocks(trace.judged_samples[:, None].astype(float), block)[:, 0] == 1.0)
