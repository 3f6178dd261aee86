"""A base model whose numbers are far off: identified anew, slow motion first.

A least squares descent on a whole recording finds the nearest minimum, and a resonance that is a third off is
behind several. Means over a quarter of a second know nothing of resonances: they set inertias and losses.
Shorter means then add what swings faster, each fit from where the one before ended (frequency continuation,
as in the inversion of seismic waves: Bunks et al., Geophysics 60, 1995).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.data._trace import Flags, Trace, blocks
from hil.analysis.diagnosis.fit._coordinates import Hypothesis
from hil.analysis.diagnosis.fit._fit import Fit, fit
from hil.analysis.diagnosis.fit._problem import Problem, problem_of
from hil.analysis.diagnosis.fit._thresholds import COARSE_BLOCKS, COARSE_S, FAR_ROUNDS

Array = npt.NDArray[np.float64]


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
